//! Range check of sensor model parameters.

use crate::Error;

/// Checks that a parameter of the sensor model lies within its range; NaN does not.
pub(super) fn check(name: &'static str, value: f32, min: f32, max: f32) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(Error::SensorModel {
            name,
            value,
            min,
            max,
        })
    }
}
