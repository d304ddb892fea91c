//! A scene on a device.

mod backend;
mod screen;

use std::sync::{Arc, Mutex};

use trapeze_gpu::NetworkPrecision;
use trapeze_scene::{Bounds, Camera, DepthRange, FrameSettings, ShDegree, is_dynamic};

pub(crate) use backend::{Backend, Cost};

use crate::device::Device;
use crate::failure::{Code, Contained, Failure, guarded, poisoned};
use crate::ffi::{DrawFigures, FrameParameters, Lens, PickFigures, RendererParameters, Stage};
use crate::frame::{background, camera, picture, settings};
use crate::image::Image;
use crate::measure::{Measurements, measure, variants};
use crate::scene::Scene;
use crate::work::Work;
use screen::Screen;

/// Draws one scene. Calls from several threads wait for each other.
#[derive(Debug)]
pub(crate) struct Renderer {
    device: Device,
    state: Mutex<Contained<State>>,
}

#[derive(Debug)]
struct State {
    scene: Arc<trapeze_scene::Scene>,
    /// The depths that are told apart are those of this box.
    framing: Option<Bounds>,
    options: Options,
    /// `None` until the next frame, when memory was asked back or the device was lost.
    backend: Option<Backend>,
    screen: Option<Screen>,
    is_suspended: bool,
    /// Newest times that the device has told.
    cost: Option<Cost>,
    draws: u32,
    /// A threshold, and how many splats are above it.
    dynamic: Option<(f32, u64)>,
}

/// How a scene is kept on the device; as exactly as can be, by default.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Options {
    pub(crate) precision: NetworkPrecision,
    pub(crate) max_sh_degree: ShDegree,
}

impl Default for Options {
    fn default() -> Self {
        Self { precision: NetworkPrecision::Single, max_sh_degree: ShDegree::Three }
    }
}

/// Draws from one that is timed to the next: a timed one waits for the device, which at every frame
/// would halve the rate.
const DRAWS_PER_SAMPLE: u32 = 32;

/// Uploads a scene.
pub(crate) fn make_renderer(
    device: &Device,
    scene: &Scene,
    options: RendererParameters,
    work: &Work,
) -> Result<Renderer, Failure> {
    guarded(|| {
        let mut state = State {
            scene: scene.shared().clone(),
            framing: scene.shared().framing_bounds(),
            options: Options::of(&options)?,
            backend: None,
            screen: None,
            is_suspended: false,
            cost: None,
            draws: 0,
            dynamic: None,
        };
        work.step(Stage::Uploading, None)?;
        state.backend(device)?;
        work.check()?;
        Ok(Renderer { device: device.clone(), state: Mutex::new(Contained::new(state)) })
    })
}

impl Options {
    fn of(parameters: &RendererParameters) -> Result<Self, Failure> {
        let precision = match parameters.half_precision {
            true => NetworkPrecision::Half,
            false => NetworkPrecision::Single,
        };
        Ok(Self { precision, max_sh_degree: ShDegree::try_from(parameters.max_harmonics_degree)? })
    }
}

impl Renderer {
    pub(crate) fn device_name(&self) -> String {
        self.device.name()
    }

    pub(crate) fn attach(&self, layer: usize, width: u32, height: u32) -> Result<(), Failure> {
        self.with(|state| {
            let size = [width, height];
            match &mut state.screen {
                Some(screen) if screen.layer() == layer => return screen.resize(size),
                // The old surface lets go of its layer first.
                screen => *screen = None,
            }
            if layer == 0 {
                return Ok(());
            }
            let Some(gpu) = self.device.gpu()? else {
                let message = "layer: expected a graphics device to draw on it, found the CPU";
                return Err(Failure::new(Code::NoDevice, message));
            };
            state.screen = Some(Screen::new(&gpu, layer, size)?);
            Ok(())
        })
    }

    pub(crate) fn show(
        &self,
        scene: &Scene,
        options: RendererParameters,
        work: &Work,
    ) -> Result<(), Failure> {
        self.with(|state| {
            let options = Options::of(&options)?;
            work.step(Stage::Uploading, None)?;
            // The old buffers go first: both together might not fit.
            state.backend = None;
            state.scene = scene.shared().clone();
            state.options = options;
            state.dynamic = None;
            state.cost = None;
            state.backend(&self.device)?;
            Ok(())
        })
    }

    pub(crate) fn draw(
        &self,
        frame: FrameParameters,
        world_to_camera: &[f64],
        clusters: &[u32],
    ) -> Result<DrawFigures, Failure> {
        self.with(|state| {
            if state.is_suspended {
                return Ok(state.figures(&frame, true));
            }
            let (camera, settings) = state.request(&frame, world_to_camera, clusters)?;
            let timed = state.draws.is_multiple_of(DRAWS_PER_SAMPLE);
            state.draws = state.draws.wrapping_add(1);
            let mut screen = state.screen.take();
            let drawn = state.on_backend(&self.device, |backend| {
                let (grown, cost) = backend.draw(&camera, &settings, timed)?;
                let shown = match &mut screen {
                    Some(screen) => screen.present(backend, background(&frame))?,
                    None => true,
                };
                Ok((grown || !shown, cost))
            });
            state.screen = screen;
            let (needs_redraw, cost) = drawn?;
            state.cost = cost.or(state.cost);
            Ok(state.figures(&frame, needs_redraw))
        })
    }

    pub(crate) fn render(
        &self,
        frame: FrameParameters,
        world_to_camera: &[f64],
        clusters: &[u32],
    ) -> Result<Image, Failure> {
        self.with(|state| {
            let (camera, settings) = state.request(&frame, world_to_camera, clusters)?;
            state.expect_awake()?;
            let rendered =
                state.on_backend(&self.device, |backend| backend.render(&camera, &settings))?;
            Ok(Image::new(picture(&rendered, &frame)))
        })
    }

    pub(crate) fn pick(
        &self,
        frame: FrameParameters,
        world_to_camera: &[f64],
        clusters: &[u32],
        x: u32,
        y: u32,
    ) -> Result<PickFigures, Failure> {
        self.with(|state| {
            let (camera, settings) = state.request(&frame, world_to_camera, clusters)?;
            state.expect_awake()?;
            let hit = state
                .on_backend(&self.device, |backend| backend.pick(&camera, &settings, (x, y)))?;
            let table = state.scene.clusters.as_ref().map(|clusters| &clusters.table);
            let cluster = hit.and_then(|hit| Some(table?[hit.label? as usize].id));
            Ok(PickFigures {
                is_hit: hit.is_some(),
                splat: hit.map_or(0, |hit| hit.splat),
                has_cluster: cluster.is_some(),
                cluster: cluster.unwrap_or(0),
                depth: hit.map_or(f64::NAN, |hit| f64::from(hit.depth)),
            })
        })
    }

    pub(crate) fn measure(
        &self,
        lens: Lens,
        world_to_camera: &[f64],
        times: &[f64],
        half_precision: &[u8],
        percentiles: &[f64],
        work: &Work,
    ) -> Result<Measurements, Failure> {
        guarded(|| {
            let camera = camera(&lens, world_to_camera)?;
            let variants = variants(half_precision, percentiles)?;
            // Without the lock: playback goes on.
            let (scene, degree) = self.with(|state| {
                state.expect_awake()?;
                Ok((state.scene.clone(), state.options.max_sh_degree))
            })?;
            measure(&self.device, &scene, degree, &camera, times, &variants, work)
        })
    }

    /// Another scene on the same device, as exactly as can be: for pictures that are not for the screen.
    pub(crate) fn offscreen(&self, scene: Arc<trapeze_scene::Scene>) -> Result<Backend, Failure> {
        self.with(|state| state.expect_awake())?;
        guarded(|| Backend::new(&self.device, scene, Options::default()))
    }

    /// Gives back the buffers on the device, which the next frame makes again at their first size.
    pub(crate) fn shed_memory(&self) -> Result<(), Failure> {
        self.with(|state| {
            state.backend = None;
            Ok(())
        })
    }

    pub(crate) fn suspend(&self) -> Result<(), Failure> {
        self.with(|state| {
            state.is_suspended = true;
            state.backend.as_ref().map_or(Ok(()), Backend::wait)
        })
    }

    pub(crate) fn resume(&self) -> Result<(), Failure> {
        self.with(|state| {
            state.is_suspended = false;
            Ok(())
        })
    }

    fn with<T>(&self, body: impl FnOnce(&mut State) -> Result<T, Failure>) -> Result<T, Failure> {
        guarded(|| body(self.state.lock().map_err(poisoned)?.get_mut()))
    }
}

impl State {
    fn request(
        &self,
        frame: &FrameParameters,
        world_to_camera: &[f64],
        clusters: &[u32],
    ) -> Result<(Camera, FrameSettings), Failure> {
        let camera = camera(&frame.lens, world_to_camera)?;
        let max_sh_degree = self.options.max_sh_degree;
        let depths = self.framing.map(|bounds| DepthRange::of(&bounds, &camera));
        let settings = settings(&self.scene, frame, clusters, depths);
        Ok((camera, FrameSettings { max_sh_degree, ..settings }))
    }

    fn expect_awake(&self) -> Result<(), Failure> {
        if self.is_suspended {
            let message =
                "renderer: expected one that is not suspended, found the app in the background";
            return Err(Failure::new(Code::DeviceFailed, message));
        }
        Ok(())
    }

    /// The scene on the device, uploaded if it is not there.
    fn backend(&mut self, device: &Device) -> Result<&mut Backend, Failure> {
        let backend = match self.backend.take() {
            Some(backend) => backend,
            None => Backend::new(device, self.scene.clone(), self.options)?,
        };
        Ok(self.backend.insert(backend))
    }

    /// Does something on the device. What was on a device that is lost is let go, so that the next
    /// call begins on another one.
    fn on_backend<T>(
        &mut self,
        device: &Device,
        body: impl FnOnce(&mut Backend) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let backend = self.backend(device)?;
        let result = body(backend);
        if result.is_err() && backend.is_lost() {
            self.backend = None;
        }
        result
    }

    fn figures(&mut self, frame: &FrameParameters, needs_redraw: bool) -> DrawFigures {
        let total = self.scene.len() as u64;
        let image = [frame.lens.width, frame.lens.height];
        let backend = self.backend.as_ref();
        let device_bytes = backend.map_or(0, |backend| backend.device_bytes(image));
        let seconds =
            |part: fn(&Cost) -> Option<f64>| self.cost.as_ref().and_then(part).unwrap_or(f64::NAN);
        DrawFigures {
            needs_redraw,
            frame_seconds: seconds(|cost| Some(cost.frame)),
            deform_seconds: seconds(|cost| cost.deform),
            sort_seconds: seconds(|cost| cost.sort),
            rasterize_seconds: seconds(|cost| cost.rasterize),
            deformed_splats: self.deformed_splats(frame.static_threshold),
            visible_splats: self.backend.as_ref().map_or(0, |b| b.visible_splats() as u64),
            total_splats: total,
            device_bytes,
        }
    }

    /// Splats that go through the network at this threshold; NaN moves all.
    fn deformed_splats(&mut self, threshold: f32) -> u64 {
        if self.scene.deformation.is_none() {
            return 0;
        }
        let motion = self.scene.motion.as_ref().filter(|_| !threshold.is_nan());
        let Some(motion) = motion else { return self.scene.len() as u64 };
        match self.dynamic {
            Some((counted, dynamic)) if counted == threshold => dynamic,
            _ => {
                let moving = motion.values.iter().filter(|&&v| is_dynamic(v, threshold));
                let dynamic = moving.count() as u64;
                self.dynamic = Some((threshold, dynamic));
                dynamic
            }
        }
    }
}
