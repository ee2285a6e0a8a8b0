// The scene: frames from /tf, and what hangs on them from /scene. It only keeps what is newest;
// draw() shows that.
import {
  AmbientLight, ArrowHelper, Box3, BoxGeometry, BufferGeometry, CanvasTexture, Color, CylinderGeometry,
  DirectionalLight, DoubleSide, GridHelper, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Sprite, SpriteMaterial, Vector3,
  WebGLRenderer, AxesHelper,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const box = new BoxGeometry(1, 1, 1);
const sphere = new SphereGeometry(0.5, 24, 16);
// Its axis is z, as in the messages.
const cylinder = new CylinderGeometry(0.5, 0.5, 1, 32).rotateX(Math.PI / 2);

/// As wide as its size says, times the scale of each end.
function roundOf({ bottom_scale: bottom, top_scale: top }) {
  if (bottom === 1 && top === 1) return cylinder;
  return new CylinderGeometry(0.5 * top, 0.5 * bottom, 1, 32).rotateX(Math.PI / 2);
}

function colourOf({ r, g, b }) {
  return new Color().setRGB(r, g, b, "srgb");
}

function place(object, { position: p, orientation: q }) {
  object.position.set(p.x, p.y, p.z);
  object.quaternion.set(q.x, q.y, q.z, q.w);
}

function solid(geometry, { pose, size, color }) {
  const material = new MeshLambertMaterial({
    color: colourOf(color), transparent: color.a < 1, opacity: color.a, depthWrite: color.a >= 1,
  });
  const mesh = new Mesh(geometry, material);
  place(mesh, pose);
  mesh.scale.set(size.x, size.y, size.z);
  mesh.castShadow = color.a >= 1;
  mesh.receiveShadow = true;
  return mesh;
}

function arrow({ pose, shaft_length, head_length, head_diameter, color }) {
  const holder = new Group();
  place(holder, pose);
  holder.add(new ArrowHelper(new Vector3(1, 0, 0), new Vector3(), shaft_length + head_length,
                             colourOf(color), head_length, head_diameter));
  return holder;
}

function line({ points, color }) {
  const geometry = new BufferGeometry().setFromPoints(points.map((p) => new Vector3(p.x, p.y, p.z)));
  return new Line(geometry, new LineBasicMaterial({ color: colourOf(color) }));
}

function triangles({ pose, points, color }) {
  const geometry = new BufferGeometry().setFromPoints(points.map((p) => new Vector3(p.x, p.y, p.z)));
  const mesh = new Mesh(geometry, new MeshBasicMaterial({
    color: colourOf(color), transparent: color.a < 1, opacity: color.a, depthWrite: color.a >= 1, side: DoubleSide,
  }));
  place(mesh, pose);
  return mesh;
}

// Always turned to who looks, and never hidden.
function label({ pose, text }) {
  const canvas = document.createElement("canvas"), height = 44;
  const context = canvas.getContext("2d"), font = "28px sans-serif";
  context.font = font;
  canvas.width = context.measureText(text).width + 24;
  canvas.height = height;
  context.fillStyle = "#1b2430d0";
  context.roundRect(0, 0, canvas.width, height, 10);
  context.fill();
  context.fillStyle = "#fff";
  context.font = font;
  context.fillText(text, 12, 32);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, sizeAttenuation: false }));
  sprite.scale.set(0.04 * canvas.width / height, 0.04, 1);
  sprite.renderOrder = 1;
  place(sprite, pose);
  return sprite;
}

function sunlight() {
  const sun = new DirectionalLight(0xffffff, 2);
  sun.position.set(0.6, -1, 2);
  sun.castShadow = true;
  Object.assign(sun.shadow.camera, { left: -0.8, right: 0.8, top: 0.8, bottom: -0.8, near: 0.5, far: 4 });
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.0005;
  return sun;
}

const fromWhere = new Vector3(0.66, -0.66, 0.48);

export class World {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(45, 1, 0.01, 20);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.lookAtAll();
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    this.scene.add(sunlight(), new AxesHelper(0.1));
    this.renderer.shadowMap.enabled = true;
    const grid = new GridHelper(2, 20, 0x8895a5, 0x8895a5);
    grid.material.transparent = true;
    grid.material.opacity = 0.35;
    grid.rotateX(Math.PI / 2);
    this.scene.add(grid);
    this.drawn = 0;
    this.hand = "";  // the frame of its base
    this.frames = new Map();  // groups by frame
    this.entities = new Map();  // groups by id
    this.dark = matchMedia("(prefers-color-scheme: dark)");
  }

  look(at, distance) {
    this.controls.target.copy(at);
    this.camera.position.copy(fromWhere).setLength(distance).add(at);
    this.controls.update();
  }

  lookAtAll() {
    this.look(new Vector3(0, 0, 0.1), 1.45);
  }

  // At what was grasped last, else at the hand.
  lookNear() {
    const grasped = [...this.entities].find(([id]) => id.startsWith("contacts/"))?.[1].parent;
    const group = grasped ?? this.frames.get(this.hand);
    if (group?.visible) this.look(new Box3().setFromObject(group).getCenter(new Vector3()), 0.55);
  }

  // Where one stands, m: the nearest to the table's middle.
  anObject() {
    return [...this.frames].filter(([name, group]) => name.startsWith("object/") && group.visible)
      .map(([, group]) => group.position.toArray()).sort((a, b) => Math.hypot(...a) - Math.hypot(...b))[0];
  }

  // Of a frame, m; what tests ask for.
  where(name) {
    return this.frames.get(name)?.position.toArray();
  }

  frame(name) {
    if (name === "table") return this.scene;
    let group = this.frames.get(name);
    if (!group) {
      group = new Group();
      group.visible = false;  // until it is told where it is
      this.frames.set(name, group);
      this.scene.add(group);
    }
    return group;
  }

  transforms({ transforms }) {
    for (const t of transforms) {
      const group = this.frame(t.child_frame_id);
      if (group === this.scene) continue;
      place(group, { position: t.translation, orientation: t.rotation });
      group.visible = true;
    }
  }

  update({ deletions, entities }) {
    for (const { id } of deletions) this.remove(id);
    for (const entity of entities) {
      this.remove(entity.id);
      const group = new Group();
      group.add(...entity.cubes.map((c) => solid(box, c)), ...entity.spheres.map((s) => solid(sphere, s)),
                ...entity.cylinders.map((c) => solid(roundOf(c), c)), ...entity.arrows.map(arrow),
                ...entity.lines.map(line), ...entity.triangles.map(triangles), ...entity.texts.map(label));
      this.frame(entity.frame_id).add(group);
      this.entities.set(entity.id, group);
    }
  }

  remove(id) {
    const group = this.entities.get(id);
    if (!group) return;
    group.removeFromParent();
    group.traverse((part) => {
      part.material?.map?.dispose();
      part.material?.dispose();
      if (part.geometry && !part.isSprite && ![box, sphere, cylinder].includes(part.geometry))
        part.geometry.dispose();
    });
    this.entities.delete(id);
  }

  clear() {
    for (const id of [...this.entities.keys()]) this.remove(id);
    for (const group of this.frames.values()) group.visible = false;
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const ratio = Math.min(devicePixelRatio, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.renderer.setClearColor(this.dark.matches ? 0x1b212a : 0xffffff);
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
    // What tests and people with the inspector look at.
    this.canvas.dataset.frames = String(++this.drawn);
    this.canvas.dataset.links = String(this.frames.size);
  }
}
