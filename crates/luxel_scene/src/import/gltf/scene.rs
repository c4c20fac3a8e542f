//! A glTF scene as entities: one per node, and below it one per primitive of its mesh.

use std::collections::HashMap;
use std::path::Path;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::{Entity, World};
use glam::{DAffine3, DVec3};
use gltf::json::Index;
use gltf::json::extensions::scene::khr_lights_punctual::Light as GltfLight;
use gltf::json::scene::Node;

use crate::assets::{AssetId, Assets, Dropped};
use crate::components::{ActiveCamera, Camera, MeshInstance, Name, Transform, Visibility};
use crate::error::SceneError;
use crate::ids::spawn;
use crate::options::LoadOptions;
use crate::report::LoadReport;

use super::super::budget::ImageBudget;
use super::super::canonical;
use super::super::frame::{Bounds, Stage, model_name, set_the_stage};
use super::super::guard::guarded;
use super::extensions::{Ignored, known_used};
use super::lights::{Light, camera, light};
use super::materials::{Look, default_material, look};
use super::nodes::{Placed, place};
use super::scenes::choose;
use super::textures::Images;
use super::{GltfFile, counted};

/// Fills `world` with one scene of a glTF file, on a stage for what it lacks. Images that `budget` has no room for are
/// left out.
pub(crate) fn load_gltf_scene(
    typed: &Path,
    world: &mut World,
    options: &LoadOptions,
    budget: ImageBudget,
) -> Result<LoadReport, SceneError> {
    let path = &canonical(typed)?;
    let model = guarded(typed, || {
        let file = GltfFile::read(path).map_err(|error| error.renamed(typed))?;
        Model::read(file, options, budget).map_err(|error| error.renamed(typed))
    })?;
    if let Some(bounds) = model.bounds {
        bounds.check(typed)?;
    }
    Ok(model.spawn(path, world, options))
}

/// One primitive, ready to be shown.
#[derive(Clone, Debug)]
struct Part {
    /// Which mesh of [`Model::assets`].
    mesh: AssetId,
    name: String,
    look: Look,
    bounds: Option<Bounds>,
}

/// Everything of a scene, checked, before anything of it is in a world.
struct Model {
    placed: Vec<Placed>,
    names: Vec<Option<String>>,
    /// The parts of each mesh that is shown.
    parts: HashMap<usize, Vec<Part>>,
    meshes: Vec<Option<usize>>,
    cameras: Vec<Option<Camera>>,
    lights: Vec<Option<Light>>,
    assets: Assets,
    bounds: Option<Bounds>,
    has_lights: bool,
    report: LoadReport,
}

impl Model {
    fn read(mut file: GltfFile, options: &LoadOptions, budget: ImageBudget) -> Result<Self, SceneError> {
        let mut ignored = Ignored::default();
        let scene = choose(&file, options)?;
        let placed = place(&file.root, &file.buffers, &scene.roots, &mut ignored)
            .map_err(|reason| SceneError::unusable(&file.path, reason))?;
        let node = |placed: &Placed| file.root.nodes.get(placed.node);
        let meshes: Vec<_> = placed.iter().map(|it| node(it)?.mesh.map(|mesh| mesh.value())).collect();
        let cameras = placed.iter().map(|it| read_camera(&file, node(it)?, &mut ignored)).collect();
        let lights = placed.iter().map(|it| read_light(&file, node(it)?, &mut ignored)).collect();
        let names = placed.iter().map(|it| name(&file, node(it)?)).collect();
        let mut model = Self {
            placed,
            names,
            parts: HashMap::new(),
            meshes,
            cameras,
            lights,
            assets: Assets::default(),
            bounds: None,
            has_lights: false,
            report: LoadReport { scenes: scene.all, ..LoadReport::default() },
        };
        model.read_meshes(&mut file, &mut ignored, scene.called, budget)?;
        model.has_lights = model.lights.iter().any(Option::is_some) || model.shines();
        model.bounds = model.measure();
        Ok(model)
    }

    /// Reads the meshes that nodes show, with their materials and images, and says what that was.
    fn read_meshes(
        &mut self,
        file: &mut GltfFile,
        ignored: &mut Ignored,
        scene: String,
        budget: ImageBudget,
    ) -> Result<(), SceneError> {
        let mut shown: Vec<usize> = self.meshes.iter().flatten().copied().collect();
        shown.sort_unstable();
        shown.dedup();
        let mut tally = Tally::default();
        let mut shapes = Vec::new();
        for &mesh in &shown {
            let Some(found) = file.root.meshes.get(mesh) else {
                let message = format!("mesh {mesh} does not exist");
                return Err(SceneError::unusable(&file.path, message));
            };
            for primitive in 0..found.primitives.len() as u32 {
                if let Some(shape) = file.shape(mesh as u32, primitive, ignored)? {
                    tally.add(shape.total, shape.dropped, shape.mended_normals);
                    shapes.push((mesh, primitive, shape));
                }
            }
        }
        let file = &*file;
        let mut images = Images::new(&file.path, &file.root, &file.buffers, budget);
        let mut looks: HashMap<Option<usize>, Look> = HashMap::new();
        for (mesh, primitive, shape) in shapes {
            let material = material_of(file, mesh, primitive, ignored);
            let assets = &mut self.assets;
            let look = *looks.entry(material).or_insert_with(|| {
                let from = material.and_then(|material| file.root.materials.get(material));
                from.map_or((default_material(), None), |from| look(from, &mut images, assets, ignored))
            });
            if shape.mesh.triangles.is_empty() {
                continue;
            }
            let bounds = Bounds::of(&shape.mesh);
            let id = assets.insert_mesh(file.asset(mesh as u32, primitive, shape.mesh, shape.dropped));
            let name = part_name(file, mesh, primitive, material);
            self.parts.entry(mesh).or_default().push(Part { mesh: id, name, look, bounds });
        }
        let materials = looks.keys().flatten().count();
        self.report.used = self.used(file, scene, shown.len(), &tally, materials, images.used());
        ignored.whole_file(&file.root, file.animations);
        self.report.ignored = ignored.lines();
        self.report.dropped.extend(tally.line(&file.name()));
        self.report.warnings.append(&mut images.warnings);
        self.report.warnings.extend(tally.warning(&file.name()));
        Ok(())
    }

    fn used(
        &self,
        file: &GltfFile,
        scene: String,
        meshes: usize,
        tally: &Tally,
        materials: usize,
        images: usize,
    ) -> Vec<String> {
        let cameras = self.cameras.iter().flatten().count();
        let lights = self.lights.iter().flatten().count();
        let mut used = vec![scene, counted(self.placed.len(), "node")];
        let triangles = counted(tally.total as usize, "triangle");
        used.push(format!(
            "{} of {} with {triangles}",
            counted(meshes, "mesh"),
            counted(tally.parts, "primitive")
        ));
        let counts = [(materials, "material"), (images, "image"), (lights, "light"), (cameras, "camera")];
        used.extend(counts.iter().filter(|(count, _)| *count > 0).map(|(count, unit)| counted(*count, unit)));
        used.extend(known_used(&file.root).into_iter().map(str::to_owned));
        used
    }

    /// Whether a surface shines.
    fn shines(&self) -> bool {
        self.parts.values().flatten().any(|part| part.look.0.emission.max_element() > 0.0)
    }

    /// The box around everything that is shown.
    fn measure(&self) -> Option<Bounds> {
        let mut whole: Option<Bounds> = None;
        for (placed, mesh) in self.placed.iter().zip(&self.meshes).filter(|(placed, _)| placed.is_visible) {
            let Some(parts) = mesh.and_then(|mesh| self.parts.get(&mesh)) else { continue };
            let Some(local) = parts.iter().filter_map(|part| part.bounds).reduce(Bounds::union) else {
                continue;
            };
            let mut add = |to_scene: DAffine3| {
                let bounds = local.transformed(to_scene);
                whole = Some(whole.map_or(bounds, |whole| whole.union(bounds)));
            };
            match &placed.instances {
                Some(instances) => instances.iter().for_each(|it| add(placed.global * it.affine())),
                None => add(placed.global),
            }
        }
        whole
    }

    fn spawn(mut self, path: &Path, world: &mut World, options: &LoadOptions) -> LoadReport {
        let ids = adopt(std::mem::take(&mut self.assets), world);
        let root = spawn(world, (model_name(path), Transform::default()));
        let mut entities: Vec<Entity> = Vec::with_capacity(self.placed.len());
        let mut active = None;
        for (index, placed) in self.placed.iter().enumerate() {
            let parent = placed.parent.and_then(|parent| entities.get(parent)).copied().unwrap_or(root);
            let entity = spawn(world, (placed.transform, ChildOf(parent)));
            entities.push(entity);
            self.dress(index, entity, world);
            if self.cameras.get(index).is_some_and(Option::is_some) && active.is_none() {
                active = Some(entity);
                world.entity_mut(entity).insert(ActiveCamera);
            }
            self.spawn_parts(index, entity, &ids, world);
        }
        let stage = Stage {
            ground: self.bounds.is_some() && active.is_none() && !self.has_lights,
            lamp: self.bounds.is_some() && !self.has_lights && options.environment.is_none(),
            camera: active.is_none(),
            sky: options.environment.is_none(),
            size: options.size,
        };
        set_the_stage(world, self.bounds.unwrap_or(Bounds::UNIT), stage);
        self.report
    }

    /// Name, camera and light of a node.
    fn dress(&self, index: usize, entity: Entity, world: &mut World) {
        let mut entity = world.entity_mut(entity);
        if let Some(name) = self.names.get(index).cloned().flatten() {
            entity.insert(Name(name));
        }
        if let Some(camera) = self.cameras.get(index).copied().flatten() {
            entity.insert(camera);
        }
        if self.placed.get(index).is_some_and(|placed| !placed.is_visible) {
            entity.insert(Visibility(false));
        }
        match self.lights.get(index).copied().flatten() {
            Some(Light::Point(light)) => drop(entity.insert(light)),
            Some(Light::Spot(light)) => drop(entity.insert(light)),
            Some(Light::Distant(light)) => drop(entity.insert(light)),
            None => {}
        }
    }

    fn spawn_parts(&self, index: usize, node: Entity, ids: &HashMap<AssetId, AssetId>, world: &mut World) {
        let mesh = self.meshes.get(index).copied().flatten();
        let once = [Transform::default()];
        let instances = self.placed.get(index).and_then(|placed| placed.instances.as_deref());
        for part in mesh.and_then(|mesh| self.parts.get(&mesh)).into_iter().flatten() {
            let Some(&mesh) = ids.get(&part.mesh) else { continue };
            let (material, textures) = part.look;
            for &transform in instances.unwrap_or(&once) {
                let shape = (Name(part.name.clone()), transform, MeshInstance { mesh }, material);
                let entity = spawn(world, (shape, ChildOf(node)));
                if let Some(mut textures) = textures {
                    textures.each_image(|image| *image = ids.get(image).copied().unwrap_or(*image));
                    world.entity_mut(entity).insert(textures);
                }
            }
        }
    }
}

/// Moves assets into the world; gives their new ids.
fn adopt(assets: Assets, world: &mut World) -> HashMap<AssetId, AssetId> {
    let mut own = world.get_resource_or_init::<Assets>();
    let mut ids = HashMap::new();
    let (meshes, images) = assets.into_meshes_and_images();
    for (id, image) in images {
        ids.insert(id, own.insert_shared_image(image));
    }
    for (id, mesh) in meshes {
        ids.insert(id, own.insert_shared_mesh(mesh));
    }
    ids
}

/// A node's name, or else that of its camera or light, so that cameras can be asked for.
fn name(file: &GltfFile, node: &Node) -> Option<String> {
    let camera = node.camera.and_then(|camera| file.root.get(camera));
    let light = light_of(node).and_then(|light| file.root.get(light));
    node.name
        .clone()
        .or_else(|| camera?.name.clone())
        .or_else(|| light?.name.clone())
        .or_else(|| camera.and(node.camera).map(|index| format!("camera {}", index.value())))
}

fn read_camera(file: &GltfFile, node: &Node, ignored: &mut Ignored) -> Option<Camera> {
    camera(ignored.existing(file.root.get(node.camera?), "cameras")?, ignored)
}

fn light_of(node: &Node) -> Option<Index<GltfLight>> {
    Some(node.extensions.as_ref()?.khr_lights_punctual.as_ref()?.light)
}

fn read_light(file: &GltfFile, node: &Node, ignored: &mut Ignored) -> Option<Light> {
    light(ignored.existing(file.root.get(light_of(node)?), "lights")?, ignored)
}

/// The material of a primitive, if there is such a one.
fn material_of(file: &GltfFile, mesh: usize, primitive: u32, ignored: &mut Ignored) -> Option<usize> {
    let mesh = file.root.meshes.get(mesh)?;
    let material = mesh.primitives.get(primitive as usize)?.material?;
    ignored.existing(file.root.get(material), "materials")?;
    Some(material.value())
}

/// What a primitive's entity is called: its mesh, and its material.
fn part_name(file: &GltfFile, mesh: usize, primitive: u32, material: Option<usize>) -> String {
    let name = file.root.meshes.get(mesh).and_then(|mesh| mesh.name.clone());
    let name = name.unwrap_or_else(|| format!("mesh {mesh}"));
    let material = material.and_then(|material| file.root.materials.get(material)?.name.clone());
    match material {
        Some(material) => format!("{name} ({material})"),
        None if primitive == 0 => name,
        None => format!("{name}.{primitive}"),
    }
}

/// Sums over all primitives.
#[derive(Debug, Default)]
struct Tally {
    parts: usize,
    total: u64,
    dropped: Dropped,
    mended_normals: u64,
}

impl Tally {
    fn add(&mut self, total: u32, dropped: Dropped, mended_normals: u32) {
        self.parts += 1;
        self.total += u64::from(total);
        self.dropped = self.dropped.plus(dropped);
        self.mended_normals += u64::from(mended_normals);
    }

    fn line(&self, file: &str) -> Option<String> {
        let (count, total) = (self.dropped.total(), self.total);
        (count > 0).then(|| format!("{file}: dropped {count} of {total} triangles ({})", self.dropped))
    }

    fn warning(&self, file: &str) -> Option<String> {
        let count = self.mended_normals;
        (count > 0).then(|| format!("{file}: {count} normals are none and were made from the faces around"))
    }
}

impl Bounds {
    fn transformed(self, affine: DAffine3) -> Self {
        let corners = self.corners().map(|corner| affine.transform_point3(corner));
        let start = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        corners.fold(start, |sum, corner| Self { min: sum.min.min(corner), max: sum.max.max(corner) })
    }
}
