// The drawing of live walks on K3D's plot: bodies, shadows, cameras and marks.
const MIN_ASPECT = 4 / 3; // width over height; in a narrower window the camera moves back until everything is visible
const MIN_MARK_SPACING = 28; // pixels between two marks

class View {
  constructor(K3D, page) {
    this.K3D = K3D;
    this.page = page;
    this.drawing = page.drawing;
    this.world = K3D.getWorld();
    this.target = document.getElementById("canvasTarget");
    this.camera = page.camera;
    this.overlay = document.querySelector(".overlay");
    this.robots = this.drawing.robots.map(() => ({ capsules: [], shadows: [], bodies: [] }));
    for (const { parts, bodies } of this.drawing.robots) {
      for (const id of Object.values(parts)) this.mesh(id).visible = false;
      for (const id of Object.values(bodies)) this.mesh(id).matrixAutoUpdate = false;
    }
    this.marks = this.drawing.marks.map(([x]) => {
      const mark = Object.assign(document.createElement("div"), { className: "mark", textContent: `${x} m` });
      this.overlay.append(mark);
      return mark;
    });
    this.tags = page.robots.length < 2 ? [] : page.robots.map(({ label, colour }) => {
      const tag = Object.assign(document.createElement("div"), { className: "tag", textContent: label });
      tag.style.setProperty("--colour", colour);
      this.overlay.append(tag);
      return tag;
    });
    this.ground = this.drawing.ground.map((id) => this.mesh(id));
    for (const mesh of this.ground) mesh.matrixAutoUpdate = false;
    this.groundMatrices = this.ground.map((mesh) => mesh.matrix.clone());
  }

  mesh(id) { return this.world.ObjectsById[id]; }

  copyMesh(id) { // a copy with its own points
    const original = this.mesh(id);
    const copy = original.clone();
    copy.geometry = original.geometry.clone();
    copy.visible = true;
    copy.matrixAutoUpdate = false;
    copy.frustumCulled = false;
    original.parent.add(copy);
    return copy;
  }

  // Creates the meshes of a robot, whose sizes are those of the compiled model.
  setRobot(number, walk) {
    const robot = this.robots[number];
    for (const { mesh } of [...robot.capsules, ...robot.shadows]) {
      mesh.parent.remove(mesh);
      mesh.geometry.dispose();
    }
    const { parts, bodies } = this.drawing.robots[number];
    const { model } = walk;
    robot.capsules = walk.robot.segments.flatMap(({ legs }, index) => {
      const bones = legs ? SIDES.flatMap((side) => ["thigh", "shank"].map((bone) => [side, `${side}_${bone}`])) : [];
      return [["trunk", "trunk"], ...bones].map(([kind, name]) => {
        const geom = walk.id("GEOM", `walker/${name}${index + 1}`);
        const mesh = this.copyMesh(parts[kind]);
        this.shapeCapsule(mesh, model.geom_size[3 * geom], model.geom_size[3 * geom + 1]);
        return { mesh, geom };
      });
    });
    robot.shadows = walk.robot.segments.map(({ length }, index) => {
      const geom = walk.id("GEOM", `walker/trunk${index + 1}`);
      return { mesh: this.copyMesh(parts.shadow), geom, body: model.geom_bodyid[geom], scale: [length, (length + 0.2) / 1.2] };
    });
    robot.bodies = Object.entries(bodies).map(([name, id]) => ({ mesh: this.mesh(id), body: walk.id("BODY", name) }));
    robot.rope = parts.rope ? (robot.rope ?? this.copyMesh(parts.rope)) : null;
  }

  shapeCapsule(mesh, radius, half) { // points as in _geom_surface of world/geometry.py
    const { ball } = this.drawing;
    const points = mesh.geometry.attributes.position;
    for (let i = 0; i < points.count; i++) {
      const [x, y, z] = [ball[3 * i], ball[3 * i + 1], ball[3 * i + 2]];
      points.setXYZ(i, x * radius, y * radius, z * radius + (z > 0 ? half : -half));
    }
    points.needsUpdate = true;
    const normals = mesh.geometry.attributes.normal;
    if (!normals) return;
    for (let i = 0; i < points.count; i++) normals.setXYZ(i, ball[3 * i], ball[3 * i + 1], ball[3 * i + 2]);
    normals.needsUpdate = true;
  }

  setSlope(slope) { // turns the ground about the start
    const angle = slope - this.page.world.slope;
    this.slope = slope;
    this.ground.forEach((mesh, number) => {
      const turn = this.groundMatrices[number].clone().makeRotationY(-angle);
      mesh.matrix.copy(this.groundMatrices[number]).premultiply(turn);
      mesh.matrixWorldNeedsUpdate = true;
    });
  }

  // --------------------------------------------------------------------------------------------------------- drawing

  drawRobot(number, walk) {
    const { data, model, mj } = walk;
    const { lane } = this.drawing.robots[number];
    const robot = this.robots[number];
    mj.mj_kinematics(model, data);
    const place = (mesh, positions, rotations, index) => {
      const [x, y, z] = positions.subarray(3 * index, 3 * index + 3);
      const r = rotations.subarray(9 * index, 9 * index + 9);
      mesh.matrix.set(r[0], r[1], r[2], x, r[3], r[4], r[5], y + lane, r[6], r[7], r[8], z, 0, 0, 0, 1);
      mesh.matrixWorldNeedsUpdate = true;
    };
    const { geom_xpos, geom_xmat, xpos, xmat } = data;
    for (const { mesh, geom } of robot.capsules) place(mesh, geom_xpos, geom_xmat, geom);
    for (const { mesh, body } of robot.bodies) place(mesh, xpos, xmat, body);
    const pitch = walk.world.slope;
    for (const { mesh, geom, body, scale } of robot.shadows) {
      const [x, y] = geom_xpos.subarray(3 * geom, 3 * geom + 2);
      const z = groundHeight(this.page, walk.world, x, y) + this.drawing.shadow_clearance;
      const yaw = Math.atan2(xmat[9 * body + 3], xmat[9 * body]);
      const [c, s, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
      const [a, b] = scale;
      mesh.matrix.set(cp * c * a, -cp * s * b, -sp, x, s * a, c * b, 0, y + lane, sp * c * a, -sp * s * b, cp, z, 0, 0, 0, 1);
      mesh.matrixWorldNeedsUpdate = true;
    }
    if (robot.rope) this.drawRope(robot.rope, walk, lane);
  }

  drawRope(mesh, walk, lane) { // a rod of length 1 along z, stretched between the ends of the rope
    const [from, to] = this.drawing.rope_ends.map((name) => {
      const site = walk.id("SITE", name);
      return walk.data.site_xpos.slice(3 * site, 3 * site + 3);
    });
    const along = to.map((value, axis) => value - from[axis]);
    const [u, v] = perpendicular(along);
    const middle = from.map((value, axis) => value + along[axis] / 2);
    mesh.matrix.set(u[0], v[0], along[0], middle[0], u[1], v[1], along[1], middle[1] + lane, u[2], v[2], along[2], middle[2], 0, 0, 0, 1);
    mesh.matrixWorldNeedsUpdate = true;
  }

  draw(walks, elapsed) { // elapsed: seconds of simulated time since the last drawing
    walks.forEach((walk, number) => this.drawRobot(number, walk));
    const points = walks.flatMap((walk, number) => this.followedPoints(walk, this.drawing.robots[number].lane));
    this.aim(points, Math.max(...walks.map(({ robot }) => robot.body_length)), elapsed);
    this.K3D.render();
    this.labelMarks(walks);
  }

  followedPoints({ data, sledgeBody }, lane) {
    const at = (array, index) => [array[3 * index], array[3 * index + 1] + lane, array[3 * index + 2]];
    const robot = at(data.subtree_com, this.page.robot_body);
    return sledgeBody > 0 ? [robot, at(data.xpos, sledgeBody)] : [robot];
  }

  // Follows the robots as aim_camera in world/cameras.py does. The filter uses only past positions; it follows a steady walk without lag.
  aim(points, size, elapsed) {
    const constants = this.drawing.camera_constants;
    const ends = [Math.min, Math.max].map((end) => [0, 1, 2].map((axis) => end(...points.map((point) => point[axis]))));
    const spread = Math.max(...[0, 1, 2].map((axis) => ends[1][axis] - ends[0][axis]));
    const wanted = [...[0, 1, 2].map((axis) => (ends[0][axis] + ends[1][axis]) / 2), spread, ends[1][1] - ends[0][1]];
    const memory = Math.exp(-elapsed / constants.smoothing_time);
    if (!this.smooth) Object.assign(this, { smooth: wanted, trend: wanted.map(() => 0) });
    else if (elapsed > 0) {
      const errors = wanted.map((value, i) => value - this.smooth[i] - this.trend[i] * elapsed);
      this.smooth = this.smooth.map((value, i) => value + this.trend[i] * elapsed + (1 - memory ** 2) * errors[i]);
      this.trend = this.trend.map((value, i) => value + (1 - memory) ** 2 * errors[i] / elapsed);
    }
    const target = this.smooth.slice(0, 3);
    if (this.camera === "free") { this.moveFreeCamera(target); return; }
    this.lastTarget = null;
    const [azimuth0, elevation0, relativeDistance] = this.drawing.cameras[this.camera];
    this.orbit = this.camera === "orbit" ? (this.orbit ?? 0) + constants.orbit_speed * elapsed : 0;
    const azimuth = (azimuth0 + this.orbit) * Math.PI / 180;
    const isDown = elevation0 <= constants.straight_down;
    let elevation = elevation0;
    if (!isDown) elevation += this.slope * 180 / Math.PI * Math.cos(azimuth);
    if (["side", "front"].includes(this.camera)) elevation -= constants.elevation_per_width * Math.min(this.smooth[4], constants.max_width);
    const height = elevation * Math.PI / 180;
    const back = Math.max(1, MIN_ASPECT * this.target.clientHeight / this.target.clientWidth);
    const distance = back * (relativeDistance * Math.max(size, constants.min_size) + constants.distance_per_spread * this.smooth[3]);
    const direction = [Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height)];
    const eye = target.map((value, axis) => value - distance * direction[axis]);
    this.K3D.setCamera([...eye, ...target, ...(isDown ? [0, 1, 0] : [0, 0, 1])]);
  }

  moveFreeCamera(target) { // moves with the robots, in the direction that the user set
    if (this.lastTarget) {
      const movement = target.map((value, axis) => value - this.lastTarget[axis]);
      this.K3D.setCamera(this.world.controls.getCameraArray().map((value, axis) => value + (axis < 6 ? movement[axis % 3] : 0)));
    }
    this.lastTarget = target;
  }

  setCamera(name) {
    this.camera = name;
    this.lastTarget = name === "free" ? this.smooth.slice(0, 3) : null;
  }

  // ------------------------------------------------------------------------------------------------------ on the screen

  project([x, y, z]) { // position of a point of the world in the picture, in pixels, and its depth
    const { x: right, y: up, z: depth } = this.world.camera.position.clone().set(x, y, z).project(this.world.camera);
    return { x: (right + 1) / 2 * this.target.clientWidth, y: (1 - up) / 2 * this.target.clientHeight, depth,
      isVisible: Math.abs(right) < 1.05 && Math.abs(up) < 1.05 && depth < 1 };
  }

  unproject(x, y, depth) { // point of the world at a position in the picture
    const right = 2 * x / this.target.clientWidth - 1, up = 1 - 2 * y / this.target.clientHeight;
    return this.world.camera.position.clone().set(right, up, depth).unproject(this.world.camera).toArray();
  }

  labelMarks(walks) {
    this.world.camera.updateMatrixWorld();
    let last = null;
    const angle = this.slope - this.page.world.slope;
    this.marks.forEach((mark, number) => {
      const [x, y, z] = this.drawing.marks[number];
      const place = this.project([x * Math.cos(angle) - z * Math.sin(angle), y, z * Math.cos(angle) + x * Math.sin(angle)]);
      const isShown = place.isVisible && !(last && Math.hypot(place.x - last.x, place.y - last.y) < MIN_MARK_SPACING);
      mark.style.display = isShown ? "" : "none";
      if (!isShown) return;
      mark.style.translate = `calc(${place.x}px - 50%) ${place.y}px`;
      last = place;
    });
    this.tags.forEach((tag, number) => {
      const [point] = this.followedPoints(walks[number], this.drawing.robots[number].lane);
      const place = this.project([point[0], point[1], point[2] + 0.35]);
      tag.style.display = place.isVisible ? "" : "none";
      tag.style.translate = `calc(${place.x}px - 50%) ${place.y}px`;
    });
  }
}
