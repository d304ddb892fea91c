//! From the numbers that Swift sends to what a renderer is asked for.

use glam::DMat4;
use trapeze_scene::{
    Camera, ClusterSet, ColorSource, DepthRange, Frame, FrameSettings, Rgba8, Scene, Selection,
    ShDegree,
};

use crate::failure::Failure;
use crate::ffi::{FrameMode, FrameParameters, Lens, Visibility};

/// A camera from its intrinsics and 16 numbers, row by row.
pub(crate) fn camera(lens: &Lens, world_to_camera: &[f64]) -> Result<Camera, Failure> {
    let matrix: [f64; 16] = world_to_camera
        .try_into()
        .map_err(|_| Failure::argument("world_to_camera", "16 numbers", world_to_camera.len()))?;
    let camera = Camera {
        width: lens.width,
        height: lens.height,
        fx: lens.fx,
        fy: lens.fy,
        cx: lens.cx,
        cy: lens.cy,
        // Columns of the transposed are rows.
        world_to_camera: DMat4::from_cols_array(&matrix).transpose(),
    };
    camera.validate()?;
    Ok(camera)
}

/// The way back.
pub(crate) fn lens_of(camera: &Camera) -> Lens {
    Lens {
        width: camera.width,
        height: camera.height,
        fx: camera.fx,
        fy: camera.fy,
        cx: camera.cx,
        cy: camera.cy,
    }
}

/// Row by row.
pub(crate) fn rows_of(camera: &Camera) -> Vec<f64> {
    camera.world_to_camera.transpose().to_cols_array().to_vec()
}

/// The settings of a frame. Ids of clusters that the scene does not have (any more) select nothing.
/// `depths` are those of the scene, if it has any.
pub(crate) fn settings(
    scene: &Scene,
    frame: &FrameParameters,
    clusters: &[u32],
    depths: Option<DepthRange>,
) -> FrameSettings {
    let labels = || -> ClusterSet {
        let known = scene.clusters.as_ref();
        clusters.iter().filter_map(|&id| known?.label_of(id)).collect()
    };
    FrameSettings {
        time: frame.time as f32,
        static_threshold: (!frame.static_threshold.is_nan()).then_some(frame.static_threshold),
        max_sh_degree: ShDegree::Three,
        selection: match frame.visibility {
            Visibility::All => Selection::All,
            Visibility::Isolate => Selection::Isolate(labels()),
            Visibility::Hide => Selection::Hide(labels()),
        },
        color_source: match frame.mode {
            FrameMode::Color => ColorSource::SphericalHarmonics,
            FrameMode::Depth => depths.map_or(ColorSource::default(), ColorSource::Depth),
            FrameMode::Clusters => ColorSource::Clusters,
            FrameMode::Motion => ColorSource::Motion,
        },
        depth: false,
        top_contributor: false,
    }
}

/// What is behind the splats.
pub(crate) fn background(frame: &FrameParameters) -> [f32; 3] {
    [frame.background_red, frame.background_green, frame.background_blue]
}

/// A frame as it is looked at, opaque.
pub(crate) fn picture(frame: &Frame, parameters: &FrameParameters) -> Rgba8 {
    Rgba8::of_colors(frame, Some(background(parameters)))
}

#[cfg(test)]
mod tests {
    use trapeze_scene::{Clusters, Splats};

    use super::*;

    fn parameters() -> FrameParameters {
        FrameParameters {
            lens: Lens { width: 4, height: 3, fx: 2.0, fy: 2.5, cx: 2.0, cy: 1.5 },
            time: 0.25,
            mode: FrameMode::Color,
            visibility: Visibility::Isolate,
            static_threshold: f32::NAN,
            background_red: 1.0,
            background_green: 0.5,
            background_blue: 0.0,
        }
    }

    #[test]
    fn a_camera_survives_the_way_to_swift_and_back() {
        let matrix: Vec<f64> =
            DMat4::from_translation([1.0, 2.0, 3.0].into()).transpose().to_cols_array().to_vec();
        let camera = camera(&parameters().lens, &matrix).unwrap();
        assert_eq!(camera.world_to_camera.w_axis.truncate().to_array(), [1.0, 2.0, 3.0]);
        assert_eq!(rows_of(&camera), matrix);
        assert_eq!(lens_of(&camera).fy, 2.5);
    }

    #[test]
    fn cameras_that_cannot_project_are_refused_by_field() {
        let error = camera(&parameters().lens, &[0.0; 15]).unwrap_err().message();
        assert_eq!(error, "world_to_camera: expected 16 numbers, found 15");
        let error = camera(&parameters().lens, &[f64::NAN; 16]).unwrap_err().message();
        assert!(error.starts_with("camera world_to_camera"), "{error}");
    }

    #[test]
    fn selections_are_by_id_and_pass_over_ids_that_are_gone() {
        let clusters = Some(Clusters::from_ids(&[40, 7], &[[0.0; 3]; 2]).unwrap());
        let scene = Scene { clusters, ..Scene::from_splats(Splats::default()) };
        let settings = settings(&scene, &parameters(), &[40, 99], None);
        assert_eq!(settings.selection, Selection::Isolate([1].into_iter().collect()));
        assert_eq!((settings.time, settings.static_threshold), (0.25, None));
    }

    #[test]
    fn depth_is_a_colour_over_the_range_of_the_scene() {
        let scene = Scene::from_splats(Splats::default());
        let depth = FrameParameters { mode: FrameMode::Depth, ..parameters() };
        let range = DepthRange { near: 1.0, far: 4.0 };
        let source = |depths| settings(&scene, &depth, &[], depths).color_source;
        assert_eq!(source(Some(range)), ColorSource::Depth(range));
        assert_eq!(source(None), ColorSource::SphericalHarmonics);
    }

    #[test]
    fn the_background_is_seen_where_nothing_was_hit() {
        let frame = Frame { width: 1, height: 1, color: vec![[0.0; 4]], ..Frame::default() };
        assert_eq!(picture(&frame, &parameters()).pixels, [255, 128, 0, 255]);
    }
}
