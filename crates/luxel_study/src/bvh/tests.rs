//! The reader of lists, against damaged records of this study.
use super::record::{Run, example};
use crate::kit::tests::{assert_refused, read};

#[test]
fn a_damaged_line_is_one_error_with_file_and_line() {
    let good = Run { dark: Some(0.5), lost_pixels: Some(3), ..example() };
    assert_refused(
        &good,
        &[
            ("\"bvh\",\"format\"", "\"octree\",\"format\"", "study 'octree'"),
            ("\"preset\":\"medium\"", "\"preset\":\"slow\"", "preset is 'slow'"),
            ("\"split\":\"sah\"", "\"split\":\"hash\"", "split is 'hash'"),
            ("\"levels\":\"two\"", "\"levels\":\"three\"", "levels is 'three'"),
            ("\"view\":\"scene\"", "\"view\":\"behind\"", "view is 'behind'"),
            ("\"triangles\":69620", "\"triangles\":0", "triangles is out of range: 0"),
            ("\"leaf_size\":8", "\"leaf_size\":0", "leaf_size is out of range: 0"),
            ("\"lost_pixels\":3", "\"lost_pixels\":9999", "lost_pixels is out of range: 9999"),
            ("\"dark\":0.5", "\"dark\":1.5", "dark is out of range: 1.5"),
            ("\"sah_cost\":31.5", "\"sah_cost\":-1.0", "sah_cost is out of range: -1"),
        ],
    );
}

#[test]
fn a_list_of_the_other_study_is_refused() {
    let theirs = serde_json::to_string(&crate::octree::example()).unwrap();
    let message = read::<Run>(&theirs).unwrap_err();
    assert!(message.contains("study 'octree': not of this study"), "{message}");
    let ours = serde_json::to_string(&example()).unwrap();
    assert!(read::<crate::octree::Run>(&ours).unwrap_err().contains("study 'bvh'"));
}
