// The hands that a headset tracks (WebXR) as glove. The picture stays that of the room, where the headset can
// show it. Its metres are real, so nothing is calibrated; while the other hand pinches, the robot's hand follows.
import { middleOfPalm, ofHeadset } from "./hand-math.js";

const byId = (id) => document.getElementById(id);

export async function hasHeadset() {
  const can = (mode) => navigator.xr?.isSessionSupported(mode).catch(() => false);
  return (await can("immersive-ar")) ? "immersive-ar" : (await can("immersive-vr")) && "immersive-vr";
}

// The 21 points of a hand, or nothing when one of them is not known.
function pointsOf(frame, source, space) {
  const all = [...source.hand.values()].map((joint) => frame.getJointPose(joint, space)?.transform.position);
  return all.every(Boolean) && all.length === 25 ? ofHeadset(all.map(({ x, y, z }) => [x, y, z])) : undefined;
}

// A session draws something, if only nothing at all.
async function emptyPicture(session) {
  const gl = document.createElement("canvas").getContext("webgl", { xrCompatible: true });
  const layer = new XRWebGLLayer(session, gl);
  await session.updateRenderState({ baseLayer: layer });
  return () => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
  };
}

// take: as of the webcam. over: called at its end, which the headset may choose. touch: told what could vibrate.
export async function startHeadset(tracker, take, over, touch) {
  const session = await navigator.xr.requestSession(await hasHeadset(), { requiredFeatures: ["hand-tracking", "local"] });
  const clear = await emptyPicture(session), space = await session.requestReferenceSpace("local");
  const leads = (source) => source.handedness === byId("headset-hand").value;
  session.onselectstart = ({ inputSource }) => leads(inputSource) || tracker.lead(true);
  session.onselectend = ({ inputSource }) => leads(inputSource) || tracker.lead(false);
  session.onend = () => {
    touch.sources = undefined;
    over();
  };
  touch.sources = () => session.inputSources;
  const next = (time, frame) => {
    session.requestAnimationFrame(next);
    clear();
    for (const source of session.inputSources) {
      const metres = source.hand && leads(source) && pointsOf(frame, source, space);
      if (metres) take({ metres, place: middleOfPalm(metres), left: source.handedness === "left", score: 1, at: performance.now() });
    }
  };
  tracker.running = true;
  tracker.stop = () => session.end().catch(() => {});
  session.requestAnimationFrame(next);
}
