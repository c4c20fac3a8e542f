//! The light probe: a cube map of six faces of 90° each (seed document 3, §5.1.1 and §5.5).
use super::section::{Label, Section, cell, rows};
use super::select::{Map, Renderer, Runs, change, is_nearer, pictures, quality_cells};
use crate::kit::figure::Part;
use crate::kit::text::count;
use crate::kit::verdict::{Case, Verdict};
use crate::voxel::ask::Sweep;
use crate::voxel::record::Run;
use crate::voxel::viewpoint::Viewpoint;

pub(super) fn sections(runs: &Runs<'_>) -> [Section; 1] {
    let (mut cases, mut parts) = (Vec::new(), Vec::new());
    let (mut adaptive_rays, mut aware_rays) = (0, 0);
    for area in runs.areas() {
        let of = |face: Viewpoint, renderer| {
            runs.at(Sweep::Probe, renderer, |run| run.area == area && run.view == face.name())
        };
        parts.push(pictures(Viewpoint::FACES.map(|face| {
            (of(face, Renderer::ErrorAware), Map::Picture, format!("{area}, {}, error-aware", face.name()))
        })));
        let mut lines = Vec::new();
        for face in Viewpoint::FACES {
            let [adaptive, aware] =
                [Renderer::Adaptive(1), Renderer::ErrorAware].map(|renderer| of(face, renderer));
            if let Some((adaptive, aware)) = adaptive.zip(aware).filter(|(adaptive, _)| adaptive.rays > 0) {
                cases.extend(is_nearer(aware, adaptive).map(Case::from));
                (adaptive_rays, aware_rays) = (adaptive_rays + adaptive.rays, aware_rays + aware.rays);
            }
            lines.push(line(face, [adaptive, aware]));
        }
        parts.push(faces(lines));
    }
    let because = format!(
        "Over all faces error-aware takes {} rays against adaptive.",
        change(aware_rays as f64 / f64::max(adaptive_rays as f64, 1.0))
    );
    [Section {
        label: Label::Further("Light probe"),
        title: "a cube map above the middle of each area".to_owned(),
        claim: Some("Expected: error-aware is nearer to the reference than adaptive on every face that shows land.".to_owned()),
        verdict: Verdict::of(&cases, because),
        notes: vec![
            "Faces are as large as the smallest pictures of table 5.29, 64² at full size; a face without land takes no counted ray."
                .to_owned(),
        ],
        parts,
    }]
}

fn line(face: Viewpoint, both: [Option<&Run>; 2]) -> Vec<String> {
    let [a, ea] = both.map(quality_cells);
    let rays = both.map(|run| cell(run, |run| count(run.rays)));
    let [psnr_a, _, ssim_a] = a;
    let [psnr_ea, _, ssim_ea] = ea;
    let [rays_a, rays_ea] = rays;
    vec![face.name().to_owned(), rays_a, rays_ea, psnr_a, psnr_ea, ssim_a, ssim_ea]
}

fn faces(lines: Vec<Vec<String>>) -> Part {
    rows(&["Face", "Rays (A)", "Rays (EA)", "PSNR (A)", "PSNR (EA)", "SSIM (A)", "SSIM (EA)"], lines)
}
