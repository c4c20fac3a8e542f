//! The reader of lists, against damaged records of this study.
use super::record::{Run, example};
use crate::kit::tests::assert_refused;

#[test]
fn a_damaged_line_is_one_error_with_file_and_line() {
    let good = Run { structure: "bvh".to_owned(), wrong_pixels: Some(0.5), ..example() };
    assert_refused(
        &good,
        &[
            ("\"octree\",\"format\"", "\"bvh\",\"format\"", "study 'bvh'"),
            ("\"wrong_pixels\":0.5", "\"wrong_pixels\":7.0", "wrong_pixels is out of range: 7"),
            ("\"quality\":\"low\"", "\"quality\":\"lower\"", "quality is 'lower'"),
            ("\"spheres\":100", "\"spheres\":0", "spheres is out of range: 0"),
            ("\"max_depth\":20", "\"max_depth\":21", "max_depth is out of range"),
        ],
    );
}
