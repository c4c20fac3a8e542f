//! A world under random edits, and what each edit must cost.
use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Quat, Vec3};
use luxel_bake::{BakeCounters, Baker};
use luxel_scene::{
    ActiveCamera, AssetId, Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, RenderSettings,
    Sphere, Surface, Transform, VolumeAsset, VolumeSource, VoxelVolume, empty_world, spawn,
};
use luxel_testkit::Random;

/// Edits after which growing turns into shrinking, or back.
const PHASE: u32 = 1000;

/// What an edit is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    Mesh,
    Volume,
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Add,
    Remove,
    Move,
    Scale,
    Material,
    /// The corners of a mesh move, for all that show it.
    Deform,
}

/// An edit, and the work that it must cause, without what follows from the snapshots and from the spheres' root cell
/// ([`crate::expect`]).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edit {
    pub(crate) kind: Kind,
    pub(crate) action: Action,
    pub(crate) cost: BakeCounters,
}

/// An object that is there now.
#[derive(Clone, Copy, Debug)]
struct Object {
    kind: Kind,
    entity: Entity,
    asset: Option<AssetId>,
}

/// A world, its baker, and a list of what is in it.
pub(crate) struct Studio {
    pub(crate) world: World,
    pub(crate) baker: Baker,
    pub(crate) camera: Entity,
    meshes: Vec<AssetId>,
    volumes: Vec<AssetId>,
    objects: Vec<Object>,
    random: Random,
    edits: u32,
}

impl Studio {
    /// A camera, and assets that nothing shows yet.
    pub(crate) fn new(seed: u32) -> Self {
        let mut world = empty_world();
        let camera =
            spawn(&mut world, (Camera::default(), ActiveCamera, Transform::at(DVec3::new(3.0, 70.0, 500.0))));
        *world.resource_mut::<RenderSettings>() =
            RenderSettings { width: 64, height: 48, ..RenderSettings::default() };
        let mut assets = world.resource_mut::<Assets>();
        let meshes =
            mesh_sources().map(|source| assets.insert_mesh(MeshAsset::from_source(source).unwrap())).to_vec();
        let volumes = volume_sources()
            .map(|source| assets.insert_volume(VolumeAsset::from_source(source).unwrap()))
            .to_vec();
        let baker = Baker::new(&mut world).unwrap();
        Self {
            world,
            baker,
            camera,
            meshes,
            volumes,
            objects: Vec::new(),
            random: Random::new(seed),
            edits: 0,
        }
    }

    /// More of everything than there ever is at once: every asset shown, and as many of each kind as there may be.
    pub(crate) fn full(seed: u32) -> Self {
        let mut studio = Self::new(seed);
        for kind in [Kind::Sphere, Kind::Mesh, Kind::Volume] {
            let all = [studio.meshes.clone(), studio.volumes.clone()].concat();
            let of_kind = |id: &&AssetId| (kind == Kind::Mesh) == studio.meshes.contains(id);
            let assets: Vec<AssetId> = all.iter().filter(of_kind).copied().collect();
            let is_unused = |studio: &Self| assets.iter().any(|id| studio.users(Some(*id)) == 0);
            while studio.count(kind) < most(kind) || (kind != Kind::Sphere && is_unused(&studio)) {
                studio.add(kind);
            }
        }
        studio
    }

    /// Does something to something.
    pub(crate) fn edit(&mut self) -> Edit {
        self.edits += 1;
        let kind = [Kind::Sphere, Kind::Sphere, Kind::Mesh, Kind::Volume][self.random.below(4) as usize];
        let action = self.action(kind);
        let cost = if action == Action::Add {
            self.add(kind)
        } else {
            let of_kind: Vec<usize> =
                (0..self.objects.len()).filter(|i| self.objects[*i].kind == kind).collect();
            let index = of_kind[self.random.below(of_kind.len() as u32) as usize];
            match action {
                Action::Remove => self.remove(index),
                Action::Move => self.shift(self.objects[index].entity),
                Action::Scale => self.scale(self.objects[index]),
                Action::Deform => self.deform(self.objects[index]),
                _ => self.paint(self.objects[index]),
            }
        };
        Edit { kind, action, cost }
    }

    /// Number of objects of a kind.
    pub(crate) fn count(&self, kind: Kind) -> usize {
        self.objects.iter().filter(|object| object.kind == kind).count()
    }

    /// Where a camera stands that looks at a random object from somewhere near it, measured by its size.
    pub(crate) fn view(&mut self) -> Transform {
        let object = self.objects[self.random.below(self.objects.len() as u32) as usize];
        let place = *self.world.get::<Transform>(object.entity).unwrap();
        let radius = self.world.get::<Sphere>(object.entity).map_or(1.0, |sphere| sphere.radius);
        let distance =
            place.scale.abs().max_element() * radius * f64::from(self.random.log_between(1.5, 30.0));
        Transform::looking_at(
            place.translation + self.random.direction().as_dvec3() * distance,
            place.translation,
        )
    }

    /// Every sphere in world space: centre and radius.
    pub(crate) fn balls(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let spheres = self.objects.iter().filter(|object| object.kind == Kind::Sphere);
        spheres.map(|object| {
            let (sphere, place) = (
                self.world.get::<Sphere>(object.entity).unwrap(),
                self.world.get::<Transform>(object.entity).unwrap(),
            );
            (place.translation, sphere.radius * place.scale.max_element())
        })
    }

    /// In every other phase more is added than removed, in the others less, so that each kind comes to its most
    /// and dies out again; the last phase grows.
    fn action(&mut self, kind: Kind) -> Action {
        let (count, most) = (self.count(kind), most(kind));
        let grows = (self.edits - 1) / PHASE % 2 == 1;
        let action = match (self.random.below(10), grows) {
            (0..3, true) | (0, false) => Action::Add,
            (3, true) | (1..4, false) => Action::Remove,
            (4..6, _) => Action::Move,
            (6..8, _) => Action::Scale,
            (8, _) if kind == Kind::Mesh => Action::Deform,
            _ => Action::Material,
        };
        match action {
            _ if count == 0 => Action::Add,
            Action::Add if count == most => Action::Remove,
            action => action,
        }
    }

    fn add(&mut self, kind: Kind) -> BakeCounters {
        let (asset, shape_cost) = match kind {
            Kind::Sphere => (None, BakeCounters::default()),
            Kind::Mesh => self.pick_asset(self.meshes.clone(), |cost| &mut cost.blas_built),
            Kind::Volume => self.pick_asset(self.volumes.clone(), |cost| &mut cost.svo_built),
        };
        let place =
            Transform { translation: self.place(), rotation: self.rotation(), scale: self.size(kind) };
        let entity = spawn(&mut self.world, place);
        let mut entity_mut = self.world.entity_mut(entity);
        let mut cost = BakeCounters { transforms_propagated: 1, ..shape_cost };
        match (kind, asset) {
            (Kind::Mesh, Some(mesh)) => _ = entity_mut.insert(MeshInstance { mesh }),
            (Kind::Volume, Some(volume)) => _ = entity_mut.insert(VoxelVolume { volume }),
            _ => _ = entity_mut.insert(Sphere { radius: 1.0 }),
        }
        self.objects.push(Object { kind, entity, asset });
        if kind == Kind::Volume {
            let palette = &self.world.resource::<Assets>().volume(asset.unwrap()).unwrap().grid.palette;
            cost.materials_written = cost.svo_built * palette.len() as u64;
        } else {
            let material = self.material();
            self.world.entity_mut(entity).insert(material);
            cost.materials_written = 1;
        }
        cost
    }

    fn remove(&mut self, index: usize) -> BakeCounters {
        let object = self.objects.swap_remove(index);
        self.world.despawn(object.entity);
        let was_last = u64::from(object.asset.is_some() && self.users(object.asset) == 0);
        match object.kind {
            Kind::Volume => BakeCounters { svo_freed: was_last, ..BakeCounters::default() },
            _ => BakeCounters { blas_freed: was_last, ..BakeCounters::default() },
        }
    }

    fn shift(&mut self, entity: Entity) -> BakeCounters {
        let (far, near, turn) = (self.place(), self.random.point(1.0).as_dvec3(), self.rotation());
        let mut place = self.world.get_mut::<Transform>(entity).unwrap();
        match self.edits % 3 {
            0 => place.translation = far,
            1 => place.translation += near,
            _ => (place.translation, place.rotation) = (place.translation * 0.75 + near, turn),
        }
        BakeCounters { transforms_propagated: 1, ..BakeCounters::default() }
    }

    /// Half of the spheres through their radius, everything else through its transform.
    fn scale(&mut self, object: Object) -> BakeCounters {
        let size = self.size(object.kind);
        if object.kind == Kind::Sphere && self.random.below(2) == 0 {
            let scale = self.world.get::<Transform>(object.entity).unwrap().scale.x;
            self.world.get_mut::<Sphere>(object.entity).unwrap().radius = size.x / scale;
            return BakeCounters::default();
        }
        let radius = self.world.get::<Sphere>(object.entity).map_or(1.0, |sphere| sphere.radius);
        self.world.get_mut::<Transform>(object.entity).unwrap().scale = size / radius;
        BakeCounters { transforms_propagated: 1, ..BakeCounters::default() }
    }

    /// Another material; a volume may also get its palette back.
    fn paint(&mut self, object: Object) -> BakeCounters {
        let mut entity = self.world.entity_mut(object.entity);
        if object.kind == Kind::Volume && entity.contains::<Material>() && self.edits.is_multiple_of(2) {
            entity.remove::<Material>();
            return BakeCounters::default();
        }
        let material = self.material();
        self.world.entity_mut(object.entity).insert(material);
        let volume = object.asset.and_then(|id| self.world.resource::<Assets>().volume(id));
        let records = volume.map_or(1, |volume| volume.grid.palette.len() as u64);
        BakeCounters { materials_written: records, ..BakeCounters::default() }
    }

    /// Other places for the corners of a mesh: a twist, a tremor, a heap, or where they came from. Deformations add up;
    /// what becomes of the tree, the bake's counters say.
    fn deform(&mut self, object: Object) -> BakeCounters {
        let id = object.asset.unwrap();
        let mut asset = MeshAsset::clone(self.world.resource::<Assets>().mesh(id).unwrap());
        let reach = asset.mesh.positions.iter().fold(0.0f32, |most, p| most.max(p.abs().max_element()));
        let random = &mut self.random;
        let positions = &mut asset.mesh.positions;
        match random.below(4) {
            0 => asset = MeshAsset::from_source(asset.source).unwrap(),
            1 => {
                let turn = random.between(-2.0, 2.0) / reach;
                let shape = Vec3::ONE + random.point(0.4);
                positions.iter_mut().for_each(|p| *p = Quat::from_rotation_y(p.y * turn) * *p * shape);
            }
            2 => positions.iter_mut().for_each(|p| *p += random.point(0.02 * reach)),
            _ => positions.iter_mut().for_each(|p| *p += random.point(reach)),
        }
        self.world.resource_mut::<Assets>().replace_mesh(id, asset).unwrap();
        BakeCounters::default()
    }

    /// Gives every mesh the shape that a scene file keeps: that of its source.
    pub(crate) fn restore_shapes(&mut self) {
        let mut assets = self.world.resource_mut::<Assets>();
        for id in &self.meshes {
            let source = assets.mesh(*id).unwrap().source.clone();
            assets.replace_mesh(*id, MeshAsset::from_source(source).unwrap()).unwrap();
        }
    }

    /// An asset, and the cost of showing it: its structure is built for its first user.
    fn pick_asset(
        &mut self,
        assets: Vec<AssetId>,
        built: fn(&mut BakeCounters) -> &mut u64,
    ) -> (Option<AssetId>, BakeCounters) {
        let asset = Some(assets[self.random.below(assets.len() as u32) as usize]);
        let mut cost = BakeCounters::default();
        *built(&mut cost) = u64::from(self.users(asset) == 0);
        (asset, cost)
    }

    fn users(&self, asset: Option<AssetId>) -> usize {
        self.objects.iter().filter(|object| object.asset == asset).count()
    }

    /// A place, every order of magnitude of the distance from the world's origin equally likely.
    fn place(&mut self) -> DVec3 {
        let distance = f64::from(self.random.between(-1.0, 3.3));
        self.random.direction().as_dvec3() * 10f64.powf(distance)
    }

    /// A size of 10^U(−3, 3). A sphere's is the same along all axes; of the others some are squeezed, some mirrored.
    fn size(&mut self, kind: Kind) -> DVec3 {
        let size = 10f64.powf(f64::from(self.random.between(-3.0, 3.0)));
        if kind == Kind::Sphere {
            return DVec3::splat(size);
        }
        // A volume is about eight cells wide.
        let size = if kind == Kind::Volume { size / 8.0 } else { size };
        let mut axis =
            || f64::from(self.random.log_between(0.5, 2.0)) * [1.0, 1.0, -1.0][self.random.below(3) as usize];
        DVec3::new(axis(), axis(), axis()) * size
    }

    fn rotation(&mut self) -> DQuat {
        match self.random.below(4) {
            // Faces along the axes: flat boxes, exact ties.
            0 => DQuat::IDENTITY,
            _ => DQuat::from_axis_angle(
                self.random.direction().as_dvec3().normalize(),
                self.random.between(0.0, 6.3).into(),
            ),
        }
    }

    fn material(&mut self) -> Material {
        let mut random = || Vec3::new(self.random.uniform(), self.random.uniform(), self.random.uniform());
        let (albedo, radiance) = (random(), random());
        let emission = if albedo.x < 0.2 { radiance * 4.0 } else { Vec3::ZERO };
        let surface = match self.random.below(3) {
            0 => Surface::Lambert { albedo },
            1 => Surface::Metal { albedo, fuzz: self.random.uniform() },
            _ => Surface::Dielectric { ior: self.random.between(1.0, 2.5), schlick: false },
        };
        Material { emission, ..surface.into() }
    }
}

/// Objects of a kind that may be there at once.
fn most(kind: Kind) -> usize {
    if kind == Kind::Sphere { 300 } else { 40 }
}

/// At most 320 triangles each; two recipes twice, so that equal content under two ids is there too.
fn mesh_sources() -> [MeshSource; 12] {
    let knot = |p, q| MeshSource::TorusKnot { p, q, tube: 0.1, segments: 32, sides: 5 };
    let terrain = |seed| MeshSource::Terrain { seed, cells: 12, height: 0.3 };
    [
        MeshSource::Quad,
        MeshSource::Quad,
        MeshSource::Cube,
        MeshSource::Cube,
        MeshSource::Icosphere { subdivisions: 0 },
        MeshSource::Icosphere { subdivisions: 1 },
        MeshSource::Icosphere { subdivisions: 2 },
        knot(2, 3),
        knot(3, 5),
        terrain(1),
        terrain(2),
        terrain(3),
    ]
}

fn volume_sources() -> [VolumeSource; 6] {
    let (menger, lantern) = (|level| VolumeSource::Menger { level }, |size| VolumeSource::Lantern { size });
    [menger(0), menger(1), menger(2), lantern(5), lantern(6), lantern(7)]
}
