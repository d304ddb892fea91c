//! What a pixel shows: at once, or without waiting.

use std::collections::VecDeque;

use trapeze_scene::{Camera, FrameSettings, NO_SPLAT};

use super::{Output, Renderer};
use crate::late_reader::{LateReader, Words};
use crate::layout::counter;
use crate::readback::Counts;
use crate::region::TILE;
use crate::tiles::Target;
use crate::{Gpu, GpuError, readback};

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Index of the top contributor.
    pub splat: u32,
    /// Label of its cluster, when the scene has clusters.
    pub cluster: Option<u32>,
    /// Median depth where transmittance falls to ½, else expected depth; world units.
    pub depth: f32,
}

/// Names a pick that was asked for, in the order of asking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PickTicket(u64);

/// A pick that was asked for.
#[derive(Clone, Debug)]
struct Request {
    ticket: PickTicket,
    camera: Camera,
    settings: FrameSettings,
    pixel: (u32, u32),
    /// Entries that there was room for when it was submitted.
    capacity: u32,
}

/// Picks that can be under way on the GPU at one time; more wait on the host.
const UNDER_WAY: usize = 4;
/// Words of a pixel in the layers.
const PIXEL_WORDS: u32 = 4;

/// One tile to blend into, and the picks that were asked for.
#[derive(Debug)]
pub(super) struct PickStage {
    pub(super) target: Target,
    reader: LateReader,
    /// Not yet on the GPU.
    waiting: VecDeque<Request>,
    /// On the GPU, in the order of the reader.
    under_way: VecDeque<Request>,
    next: u64,
}

impl PickStage {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let words = PIXEL_WORDS + counter::COUNT as u32;
        Ok(Self {
            target: Target::new(gpu)?,
            reader: LateReader::new(gpu, words, UNDER_WAY)?,
            waiting: VecDeque::new(),
            under_way: VecDeque::new(),
            next: 0,
        })
    }
}

impl Renderer {
    /// What is seen at pixel (x, y), or `None` where nothing is or outside the image. Only that
    /// pixel's tile is blended; the image of the last frame stays.
    ///
    /// # Errors
    /// Those of [`render`](Self::render).
    pub fn pick(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        (x, y): (u32, u32),
    ) -> Result<Option<Pick>, GpuError> {
        camera.validate()?;
        if x >= camera.width || y >= camera.height {
            return Ok(None);
        }
        self.draw_until_complete(camera, settings, true, Output::Tile([x / TILE, y / TILE]))?;
        let pixels = u64::from(TILE * TILE);
        let values: Vec<[u32; 4]> = readback::read(&self.gpu, &self.pick.target.layers, pixels)?;
        Ok(self.seen(values[pixel_of_tile((x, y)) as usize]))
    }

    /// Asks what is seen at pixel (x, y), without waiting: the same as [`pick`](Self::pick), whose
    /// answer [`answered_pick`](Self::answered_pick) gives after a frame or two.
    ///
    /// # Errors
    /// [`GpuError`] when the camera cannot project or the device is lost.
    pub fn request_pick(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
        pixel: (u32, u32),
    ) -> Result<PickTicket, GpuError> {
        camera.validate()?;
        self.gpu.check()?;
        let ticket = PickTicket(self.pick.next);
        self.pick.next += 1;
        self.pick.waiting.push_back(Request {
            ticket,
            camera: camera.clone(),
            settings: settings.clone(),
            pixel,
            capacity: 0,
        });
        self.submit_picks()?;
        Ok(ticket)
    }

    /// A pick that has been answered since the last call; `None` while there is none. Never waits.
    /// When a pixel's tile needs larger buffers than there are, they grow, and it is asked again.
    ///
    /// # Errors
    /// [`GpuError`] when the tile does not fit into the device (the pick is given up), or the
    /// device is lost.
    pub fn answered_pick(&mut self) -> Result<Option<(PickTicket, Option<Pick>)>, GpuError> {
        self.gpu.poll()?;
        self.submit_picks()?;
        if self.pick.under_way.is_empty() {
            // Pixels outside the image need no GPU.
            let outside = self.pick.waiting.pop_front();
            return Ok(outside.map(|request| (request.ticket, None)));
        }
        let Some((_, words)) = self.pick.reader.take()? else { return Ok(None) };
        let Some(request) = self.pick.under_way.pop_front() else { return Ok(None) };
        let (pixel, counts) = words.split_at(PIXEL_WORDS as usize);
        let counts = Counts::from_words(counts);
        if counts.most_entries > request.capacity {
            self.make_room(counts, 1)?;
            self.pick.waiting.push_front(request);
            self.submit_picks()?;
            return Ok(None);
        }
        Ok(Some((request.ticket, self.seen([pixel[0], pixel[1], pixel[2], pixel[3]]))))
    }

    /// Brings waiting picks onto the GPU, as many as can be under way.
    fn submit_picks(&mut self) -> Result<(), GpuError> {
        while let Some(request) = self.pick.waiting.front() {
            let (x, y) = request.pixel;
            let outside = x >= request.camera.width || y >= request.camera.height;
            if outside || self.pick.under_way.len() == UNDER_WAY {
                return Ok(());
            }
            let Some(mut request) = self.pick.waiting.pop_front() else { return Ok(()) };
            request.capacity = self.entries.pairs.capacity;
            let output = Output::Tile([x / TILE, y / TILE]);
            let mut encoder =
                self.encode(&request.camera, &request.settings, true, output, false)?;
            let seen = Words {
                buffer: &self.pick.target.layers,
                first: PIXEL_WORDS * pixel_of_tile(request.pixel),
                count: PIXEL_WORDS,
            };
            let counts =
                Words { buffer: &self.order.counts, first: 0, count: counter::COUNT as u32 };
            self.pick.reader.record(&mut encoder, request.ticket.0, &[seen, counts]);
            self.gpu.queue().submit([encoder.finish()]);
            self.pick.reader.submitted();
            self.pick.under_way.push_back(request);
        }
        Ok(())
    }

    /// A pixel of the layers: bits of expected and median depth, splat, label.
    fn seen(&self, [expected, median, splat, label]: [u32; 4]) -> Option<Pick> {
        let (expected, median) = (f32::from_bits(expected), f32::from_bits(median));
        (splat != NO_SPLAT).then(|| Pick {
            splat: self.index_in_scene(splat),
            cluster: self.scene.clusters.as_ref().map(|_| label),
            depth: if median.is_nan() { expected } else { median },
        })
    }
}

/// Index of a pixel in the tile that it lies in.
fn pixel_of_tile((x, y): (u32, u32)) -> u32 {
    (y % TILE) * TILE + x % TILE
}
