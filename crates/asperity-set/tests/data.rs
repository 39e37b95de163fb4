//! Sets are written and read back to the bit, and what is no set is refused.

mod common;

use std::fmt::Debug;
use std::sync::Arc;

use asperity_set::{Convex, CustomStar, Ellipse, Ellipsoid, Star, StarSet, Superellipse, Vector};
use common::*;
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The same set out of both formats; a printed number has all its digits.
fn returns<T: Serialize + DeserializeOwned + Debug + PartialEq>(set: &T) {
    let json = serde_json::to_string(set).unwrap();
    let toml = toml::to_string(set).unwrap();
    for read in [serde_json::from_str::<T>(&json).unwrap(), toml::from_str(&toml).unwrap()] {
        assert_eq!(&read, set, "{toml}");
        assert_eq!(format!("{read:?}"), format!("{set:?}"), "{toml}");
    }
}

proptest! {
    #![proptest_config(cases(0.02))]

    #[test]
    fn planar_sets_come_back_to_the_bit(set in star(), other in convex()) {
        returns(&set);
        returns(&other);
    }

    #[test]
    fn sets_in_space_come_back_to_the_bit(set in convex_in_space()) {
        returns(&set);
        returns(&Star::from(set));
    }

    #[test]
    fn sets_on_a_line_come_back_to_the_bit(set in plain::<1>(2.0)) {
        returns(&set);
    }
}

fn read(toml: &str) -> Result<Star<2>, String> {
    toml::from_str(toml).map_err(|error| error.to_string())
}

#[test]
fn names_and_arguments_are_those_of_the_constructors() {
    let ellipse = Ellipse::new(Vector::<2>::new(0.54, 0.48)).unwrap();
    let turned = Convex::from(ellipse).rotated(0.3).unwrap();
    let text = toml::to_string(&turned).unwrap();
    assert_eq!(text, "type = \"Ellipse\"\na = 0.54\nb = 0.48\nangle = 0.3\n");
    let smooth = Star::from(Superellipse::new(Vector::<2>::new(0.5, 0.4), 2.5).unwrap());
    let expected = smooth.rotated(-0.2).unwrap();
    let text = "type = \"Superellipse\"\na = 0.5\nb = 0.4\nexponent = 2.5\nangle = -0.2\n";
    assert_eq!(read(text).unwrap(), expected);
    let sets = "type = \"Union\"\n[[sets]]\ntype = \"Disk\"\nradius = 1.0\n[[sets]]\n\
                type = \"Rectangle\"\na = 2.0\nb = 0.5\n";
    assert_eq!(read(sets).unwrap().gauge(&Vector::<2>::new(4.0, 0.0)), 2.0);
    let axes: Convex<3> = Ellipsoid::new(Vector::<3>::new(1.0, 2.0, 3.0)).unwrap().into();
    let text = toml::to_string(&axes).unwrap();
    assert_eq!(text, "type = \"Ellipsoid\"\nsemi_axes = [1.0, 2.0, 3.0]\n");
}

#[test]
fn what_is_no_set_is_refused() {
    for (text, complaint) in [
        ("type = \"Ellipse\"\na = 0.5\nb = -0.4", "semi_axes: must be"),
        ("type = \"Ellipse\"\na = 0.5\nb = nan", "semi_axes: must be"),
        ("type = \"Ellipse\"\na = 0.5", "missing field `b`"),
        ("type = \"Ellipse\"\na = 0.5\nb = 0.4\nturn = 1.0", "unknown field `turn`"),
        ("type = \"Elipse\"\na = 0.5\nb = 0.4", "unknown variant `Elipse`"),
        ("a = 0.5\nb = 0.4", "missing field `type`"),
        ("type = \"Ball\"\nradius = 1.0", "set: must be one of R^2"),
        ("type = \"Interval\"\nlower = -1.0\nupper = 1.0", "set: must be one of R^2"),
        ("type = \"Ellipsoid\"\nsemi_axes = [1.0]", "semi_axes: must have 2 entries"),
        (
            "type = \"Ellipsoid\"\nsemi_axes = [1.0, 2.0]\naxes = [[1.0, 1.0], [0.0, 1.0]]",
            "axes: must have orthonormal columns",
        ),
        ("type = \"Box\"\nlower = [-1.0, -1.0]", "half_widths: must be given"),
        ("type = \"Box\"\nhalf_widths = [1.0, 1.0]\nlower = [-1.0, -1.0]", "half_widths: must be"),
        ("type = \"Polygon\"\nvertices = [[1.0, 0.0], [0.0, 1.0]]", "vertices: must hold"),
        ("type = \"PolarCurve\"\nangle = [0.0, 2.0, 4.0]\nradius = [1.0]", "radius: must"),
        ("type = \"Union\"\nsets = []", "sets: must"),
        (
            "type = \"MinkowskiSum\"\nsets = [{ type = \"Superellipse\", a = 1.0, b = 1.0, \
             exponent = 0.5 }]",
            "sets: must be convex",
        ),
        (
            "type = \"Mapped\"\nset = { type = \"Disk\", radius = 1.0 }\nmatrix = [[1.0], [0.0]]",
            "matrix: must have 2 rows",
        ),
        (
            "type = \"Mapped\"\nset = { type = \"Disk\", radius = 1.0 }\n\
             matrix = [[1.0, 1.0], [1.0, 1.0]]",
            "matrix: must be finite and regular",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(complaint), "{text}\n{error}");
    }
    let cusped = "type = \"Superellipse\"\na = 1.0\nb = 1.0\nexponent = 0.5";
    assert!(read(cusped).is_ok());
    assert!(toml::from_str::<Convex<2>>(cusped).unwrap_err().to_string().contains("convex"));
}

#[test]
fn sets_of_users_are_not_written() {
    let own: Arc<dyn StarSet<2>> = Arc::new(Ellipse::new(Vector::<2>::new(0.5, 0.4)).unwrap());
    let own = Star::Custom(CustomStar(own));
    for set in [own.clone(), Star::union(&[own]).unwrap()] {
        let error = serde_json::to_string(&set).unwrap_err().to_string();
        assert_eq!(error, "set: of a user holds code and cannot be written");
    }
}
