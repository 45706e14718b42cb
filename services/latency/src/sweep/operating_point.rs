//! Operating points of a sweep: frame source and conditions for each value of the parameter.

use crate::arguments::SourceArguments;
use crate::sweep_axis::SweepAxis;
use service::Failure;

/// Operating point of a sweep: the conditions of one measurement.
#[derive(Debug, Clone)]
pub(super) struct OperatingPoint {
    /// Value of the swept parameter.
    pub(super) value: f64,
    /// Frame source of this operating point.
    pub(super) source: SourceArguments,
    /// Number of views taught beforehand.
    pub(super) n_views: usize,
    /// Side of the boxes of a generated scene, metres; `None` for other sources.
    pub(super) box_side_m: Option<f64>,
    /// Number of cores for the daemon; `None` for all.
    pub(super) n_cores: Option<usize>,
}

/// Operating point with a cheap source, so that the daemon dominates the measurement.
fn crowd(n_objects: u32) -> OperatingPoint {
    OperatingPoint {
        value: f64::from(n_objects),
        source: SourceArguments::of(&format!("crowd:{n_objects}")),
        n_views: 0,
        box_side_m: None,
        n_cores: None,
    }
}

/// Number of objects in sweeps of other parameters.
const N_OBJECTS: u32 = 10;

/// Operating points of the given values, or of the default values if none are given.
///
/// # Errors
/// If a value is not permitted.
pub(super) fn operating_points(
    axis: SweepAxis,
    values: &[u32],
) -> Result<Vec<OperatingPoint>, Failure> {
    let possible = axis.permitted_values();
    if let Some(value) = values.iter().find(|value| !possible.contains(value)) {
        let (least, most) = (possible.start(), possible.end());
        return Err(Failure::usage(format!(
            "a value of {} is from {least} to {most}, not {value}",
            axis.word()
        )));
    }
    let values = if values.is_empty() {
        axis.default_values()
    } else {
        values
    };
    Ok(values
        .iter()
        .map(|value| operating_point(axis, *value))
        .collect())
}

fn operating_point(axis: SweepAxis, value: u32) -> OperatingPoint {
    let mut point = crowd(N_OBJECTS);
    point.value = f64::from(value);
    match axis {
        SweepAxis::Objects => point = crowd(value),
        SweepAxis::Points => point.box_side_m = Some(f64::from(value) / 1000.0),
        SweepAxis::Views => point.n_views = value as usize,
        SweepAxis::Rate => point.source.rate = Some(f64::from(value)),
        SweepAxis::Cores => point.n_cores = Some(value as usize),
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn default_values_are_permitted() {
        for axis in SweepAxis::value_variants() {
            let points = operating_points(*axis, &[]).unwrap();
            assert_eq!(points.len(), axis.default_values().len());
            assert!(operating_points(*axis, axis.default_values()).is_ok());
        }
    }

    #[test]
    fn values_out_of_range_are_refused_with_the_range() {
        let refused = operating_points(SweepAxis::Objects, &[4, 0]).unwrap_err();
        assert!(refused.sentence.contains("from 1 to 256, not 0"));
        let chosen = operating_points(SweepAxis::Rate, &[60]).unwrap();
        assert_eq!(chosen[0].source.rate, Some(60.0));
    }
}
