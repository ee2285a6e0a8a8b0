// Starts what the manifests start (lab.mjs). Then startup, readiness and liveness probes, the outcome of
// the jobs, and that a container is locked up and a stranger is shut out.
// Exit code 77: skipped. With PREHEND_LONG also the two sites, a recording, a planner and two hands.
import { chmodSync, mkdirSync, readdirSync } from "node:fs";
import { Lab, begin, clean, docker, images } from "./lab.mjs";

const folder = begin();

/** Labs that share a network, each with the addresses that its pods must have. */
async function together(labs, addresses, subnet) {
  const network = `${labs[0].name}-net`;
  docker("network", "create", ...(subnet ? ["--subnet", subnet] : []), network);
  try {
    for (const lab of labs) for (const pod of lab.pods) lab.hold(pod, network, addresses[pod.name]);
    for (const lab of labs) for (const pod of lab.pods) lab.shut(pod);
    for (const lab of labs) for (const pod of lab.pods) lab.start(pod);
    for (const lab of labs) await lab.prove();
    if (!subnet) for (const lab of labs) {
      await lab.stopOutlivesItsPod(network);
      lab.strangerIsShutOut(network);
    }
  } finally {
    clean();
    docker("network", "rm", network);
  }
}

/** Secrets of the two sites, by their names. */
function keys(folder, rig) {
  mkdirSync(`${folder}/keys`);
  chmodSync(`${folder}/keys`, 0o777);
  docker("run", "--rm", "-v", `${folder}/keys:/made`, "--entrypoint", "prehend", images[0],
    "keys", "init", "/made/store", "--rig", rig);
  const roles = readdirSync(`${folder}/keys/store`, { withFileTypes: true }).filter((one) => one.isDirectory());
  return Object.fromEntries(roles.map((one) => [`keys-${one.name}`, `${folder}/keys/store/${one.name}`]));
}

await together([new Lab("demo", folder)], {});
if (process.env.PREHEND_LONG) {
  await together([new Lab("replay", folder)], {});
  await together([new Lab("planned", folder)], {});
  await together([new Lab("two-hands", folder)], {});
  const secrets = keys(folder, "sites");
  const robot = new Lab("robot-site-planned", folder, secrets), glove = new Lab("glove-site", folder, secrets);
  const gateway = robot.objects.find((o) => o.kind === "ConfigMap").data.GATEWAY;
  await together([robot, glove], { robot: gateway }, gateway.replace(/\d+$/, "0/24"));
}
console.log("the manifests' containers do what they are for");
