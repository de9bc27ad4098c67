//! Material textures with their mip chains, and samplers; each is made when a material first asks
//! for it.

use crate::Error;
use gpu_context::{
    Gpu, Mipmaps,
    upload::{self, Encoding},
};
use scene::{ColorSpace, Scene, TextureRef, Wrap};
use std::collections::HashMap;

/// Samples along the longer axis of a pixel's footprint.
const ANISOTROPY: u16 = 8;

/// The textures that a scene's materials use.
pub(crate) struct Textures<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    views: HashMap<usize, wgpu::TextureView>,
    samplers: HashMap<([Wrap; 2], bool), wgpu::Sampler>,
    mipmaps: HashMap<Encoding, Mipmaps>,
    white: Option<wgpu::TextureView>,
}

impl<'a> Textures<'a> {
    pub(crate) fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        let (views, samplers, mipmaps) = (HashMap::new(), HashMap::new(), HashMap::new());
        Self { gpu, scene, views, samplers, mipmaps, white: None }
    }

    /// The view and sampler of a material's texture, or a white texel where it has none.
    /// `place` names the material in errors.
    pub(crate) fn get(
        &mut self,
        place: &str,
        texture: Option<&TextureRef>,
    ) -> Result<(wgpu::TextureView, wgpu::Sampler), Error> {
        let Some(texture) = texture else {
            return Ok((self.white()?, self.sampler([Wrap::Repeat; 2], false)));
        };
        Ok((self.view(place, texture.texture)?, self.sampler(texture.wrap, texture.nearest)))
    }

    fn white(&mut self) -> Result<wgpu::TextureView, Error> {
        if let Some(view) = &self.white {
            return Ok(view.clone());
        }
        let texture = upload::rgba8(self.gpu, "white", 1, 1, &[255; 4], Encoding::Linear, None)?;
        Ok(self.white.insert(all_of(&texture)).clone())
    }

    fn view(&mut self, place: &str, index: usize) -> Result<wgpu::TextureView, Error> {
        if let Some(view) = self.views.get(&index) {
            return Ok(view.clone());
        }
        let count = self.scene.textures.len();
        let image = self.scene.textures.get(index).ok_or_else(|| {
            let expected = format!("an index below {count}");
            scene::Error::new(&self.scene.name, place, format!("texture {index}"), expected)
        })?;
        let encoding = match image.color_space {
            ColorSpace::Srgb => Encoding::Srgb,
            ColorSpace::Linear => Encoding::Linear,
        };
        let mips = self.mips(encoding)?;
        let (width, height) = (image.width, image.height);
        let texture =
            upload::rgba8(self.gpu, &image.name, width, height, &image.rgba, encoding, Some(&mips))?;
        let view = all_of(&texture);
        self.views.insert(index, view.clone());
        Ok(view)
    }

    fn mips(&mut self, encoding: Encoding) -> Result<Mipmaps, Error> {
        if let Some(mips) = self.mipmaps.get(&encoding) {
            return Ok(mips.clone());
        }
        let mips = Mipmaps::new(self.gpu, encoding.rgba8_format())?;
        self.mipmaps.insert(encoding, mips.clone());
        Ok(mips)
    }

    fn sampler(&mut self, wrap: [Wrap; 2], nearest: bool) -> wgpu::Sampler {
        let make = || self.gpu.device().create_sampler(&sampler_descriptor(wrap, nearest));
        self.samplers.entry((wrap, nearest)).or_insert_with(make).clone()
    }
}

fn sampler_descriptor(wrap: [Wrap; 2], nearest: bool) -> wgpu::SamplerDescriptor<'static> {
    let [address_mode_u, address_mode_v] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    wgpu::SamplerDescriptor {
        label: Some("material"),
        address_mode_u,
        address_mode_v,
        mag_filter: if nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear },
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        // WebGPU allows anisotropy only where every filter is linear.
        anisotropy_clamp: if nearest { 1 } else { ANISOTROPY },
        ..wgpu::SamplerDescriptor::default()
    }
}

pub(crate) fn all_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
