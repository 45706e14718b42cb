//! Range checks of settings and other numbers. NaN is outside every range.
//!
//! # Example
//!
//! ```
//! use value_range::check_range;
//!
//! assert_eq!(check_range("gain", 0.5, 0.0, 1.0), Ok(()));
//! let error = check_range("gain", f64::NAN, 0.0, 1.0).unwrap_err();
//! assert_eq!(error.to_string(), "gain is NaN but must lie between 0 and 1");
//! ```

/// Error of a number outside its valid range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{name} is {value} but must lie between {min} and {max}")]
pub struct OutOfRange<T = f64> {
    /// Name of the number.
    pub name: &'static str,
    /// Rejected value.
    pub value: T,
    /// Least valid value.
    pub min: T,
    /// Greatest valid value.
    pub max: T,
}

/// Checks that a number lies within its range, bounds included.
///
/// # Errors
/// When it does not.
pub fn check_range<T: PartialOrd>(
    name: &'static str,
    value: T,
    min: T,
    max: T,
) -> Result<(), OutOfRange<T>> {
    if min <= value && value <= max {
        return Ok(());
    }
    Err(OutOfRange {
        name,
        value,
        min,
        max,
    })
}

/// Checks numbers, given as (name, value, minimum, maximum).
///
/// # Errors
/// The first one that is outside its range.
pub fn check_ranges<T: PartialOrd + Copy>(
    numbers: &[(&'static str, T, T, T)],
) -> Result<(), OutOfRange<T>> {
    let mut numbers = numbers.iter();
    numbers.try_for_each(|&(name, value, min, max)| check_range(name, value, min, max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_includes_its_bounds_and_nothing_else() {
        for (value, is_inside) in [
            (1.0, true),
            (2.0, true),
            (0.99, false),
            (2.01, false),
            (f64::NAN, false),
            (f64::INFINITY, false),
        ] {
            assert_eq!(
                check_range("x", value, 1.0, 2.0).is_ok(),
                is_inside,
                "{value}"
            );
        }
        assert!(check_range("x", 1.0, 2.0, f64::NAN).is_err());
    }

    #[test]
    fn first_number_out_of_range_is_named() {
        let numbers = [
            ("a", 1.0, 0.0, 2.0),
            ("b", 3.0, 0.0, 2.0),
            ("c", 9.0, 0.0, 2.0),
        ];
        let error = check_ranges(&numbers).unwrap_err();
        assert_eq!(error.to_string(), "b is 3 but must lie between 0 and 2");
        assert_eq!(check_ranges(&numbers[..1]), Ok(()));
    }
}
