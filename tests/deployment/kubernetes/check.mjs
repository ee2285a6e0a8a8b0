// Every object that kustomize makes of the overlays is held against the API's schemas twice: by the
// validators (what is missing, what has a wrong value) and as a literal of the API's TypeScript type,
// whose compiler also refuses fields that the API does not know. Then what we promise of every pod.
// That the check can fail is checked too: a misspelt field must be refused.
import { execFileSync } from "node:child_process";
import { readdirSync, existsSync } from "node:fs";
import assert from "node:assert/strict";
import ts from "typescript";
import { objects, pods, policies } from "./manifests.mjs";

const root = process.argv[2];

/** What the compiler says of the objects as literals of their types; one source for all. */
function refusals(list) {
  const source = list
    .map((o, i) => `import type { I${o.kind} as T${i} } from "kubernetes-models/${o.apiVersion}/${o.kind}";
export const x${i}: T${i} = ${JSON.stringify(o)};`)
    .join("\n");
  const name = `${process.cwd()}/manifests.ts`;
  const options = { strict: true, noEmit: true, skipLibCheck: true, module: ts.ModuleKind.NodeNext,
                    moduleResolution: ts.ModuleResolutionKind.NodeNext, types: [] };
  const host = ts.createCompilerHost(options);
  const { getSourceFile, fileExists, readFile } = host;
  host.fileExists = (file) => file === name || fileExists(file);
  host.readFile = (file) => (file === name ? source : readFile(file));
  host.getSourceFile = (file, ...more) =>
    file === name ? ts.createSourceFile(file, source, ts.ScriptTarget.Latest)
                  : getSourceFile(file, ...more);
  return ts.getPreEmitDiagnostics(ts.createProgram([name], options, host))
    .map((d) => ts.flattenDiagnosticMessageText(d.messageText, "\n"));
}

async function check(o) {
  const module = await import(`kubernetes-models/${o.apiVersion}/${o.kind}`);
  new module[o.kind](o).validate();
}

function locked(container, where) {
  assert.equal(container.securityContext.readOnlyRootFilesystem, true, where);
  assert.equal(container.securityContext.allowPrivilegeEscalation, false, where);
  assert.deepEqual(container.securityContext.capabilities.drop, ["ALL"], where);
  assert.ok(container.resources.limits.memory, `${where} may take all memory`);
}

/** A stop of the hand outlives its pod: who moves one keeps it in a claim, which comes with the overlay. */
function keepsItsStop(pod, claims, where) {
  for (const container of pod.containers.filter((one) => one.command.includes("prehend-simulation"))) {
    const folder = container.command.map((word) => /^safety\.state=(.+)/.exec(word)?.[1]).find(Boolean);
    const mount = container.volumeMounts.find((one) => one.mountPath === folder && !one.readOnly);
    const claim = pod.volumes.find((one) => one.name === mount?.name)?.persistentVolumeClaim?.claimName;
    assert.ok(claims.includes(claim), `${where} keeps no stop`);
    assert.equal(pod.securityContext.fsGroup, container.securityContext.runAsGroup ?? pod.securityContext.runAsGroup, where);
  }
}

function promises(overlay, o, claims) {
  const pod = o.spec?.template?.spec;
  if (!pod) return;
  const where = `${overlay}: ${o.kind} ${o.metadata.name}`;
  assert.equal(pod.securityContext.runAsNonRoot, true, where);
  assert.equal(pod.automountServiceAccountToken, false, where);
  keepsItsStop(pod, claims, where);
  for (const container of pod.initContainers ?? []) locked(container, where);
  for (const container of pod.containers) {
    locked(container, where);
    if (o.kind === "Deployment" && o.metadata.name !== "discovery") {
      // What restarts a container asks its process and nothing else: with a discovery server or a
      // network between, one fault would end every process of the lab.
      for (const probe of [container.startupProbe, container.livenessProbe])
        assert.match(probe.exec.command.join(" "), new RegExp(`^prehend alive ${container.name}( --set |$)`), where);
      const ready = `prehend status --wait ${container.name} --timeout 4`;
      assert.ok(container.readinessProbe.exec.command.join(" ").startsWith(ready), where);
    }
  }
}

/** Each pod is shut but for what a policy names, and a policy names no pod, port or address that
    nothing stands behind. */
function shut(overlay, list) {
  const all = pods(list);
  for (const pod of all) {
    const where = `${overlay}: ${pod.name}`, held = policies(list, pod);
    for (const type of ["Ingress", "Egress"])
      assert.ok(held.some((o) => o.spec.policyTypes.includes(type) && !o.spec.ingress && !o.spec.egress),
        `${where} is open for ${type}`);
    // Ports that are named to others are open to somebody.
    const open = held.flatMap((o) => o.spec.ingress ?? []).flatMap((rule) => rule.ports);
    for (const port of pod.spec.containers.flatMap((one) => one.ports ?? []))
      assert.ok(open.some((one) => one.protocol === port.protocol &&
        (one.port === port.name || (one.port <= port.containerPort &&
                                    port.containerPort <= (one.endPort ?? one.port)))),
        `${where}: nobody gets through to port ${port.containerPort}`);
  }
  for (const policy of list.filter((o) => o.kind === "NetworkPolicy")) {
    const where = `${overlay}: ${policy.metadata.name}`;
    assert.ok(all.some((pod) => policies([policy], pod).length), `${where} holds for no pod`);
    for (const rule of [...(policy.spec.ingress ?? []), ...(policy.spec.egress ?? [])])
      assert.ok(rule.ports?.length, `${where} opens every port`);
  }
}

/** The two sites have one rig, and what one dials the other forwards to who listens there. */
function sites() {
  const find = (overlay, kind) => objects(root, overlay).find((o) => o.kind === kind);
  const here = find("robot-site", "ConfigMap").data, there = find("glove-site", "ConfigMap").data;
  assert.equal(here.PREHEND_LAB_RIG, there.PREHEND_LAB_RIG);
  const ports = find("robot-site", "Service").spec.ports;
  const dialled = ports.map((one) => `${here.GATEWAY}:${one.port}`);
  assert.deepEqual(JSON.parse(there.PREHEND_LAB_PEERS), dialled);
  const out = objects(root, "glove-site").find((o) => o.metadata.name === "robot-site").spec.egress[0];
  assert.equal(out.to[0].ipBlock.cidr, `${here.GATEWAY}/32`);
  for (const one of ports)
    assert.ok(out.ports.some((open) => open.port <= one.port && one.port <= open.endPort), `${one.port}`);
  for (const container of find("robot-site", "Deployment").spec.template.spec.containers) {
    const port = ports.find((one) => one.targetPort === container.name).port;
    assert.ok(container.command.includes(`lab.listen=$(GATEWAY):${port}`), container.name);
    assert.ok(container.ports.some((one) => one.name === container.name && one.containerPort === port));
  }
}

/** Every shard of the study has its pod, and a file that outlives it. */
function shards() {
  const list = objects(root, "study"), find = (kind) => list.find((o) => o.kind === kind);
  const job = find("Job").spec, { SHARDS, OPTIONS } = find("ConfigMap").data;
  assert.equal(job.completionMode, "Indexed");
  assert.equal(`${job.completions}`, SHARDS, "another number of shards than of pods");
  const [container] = job.template.spec.containers;
  const run = (index) => execFileSync("sh", ["-c", `prehend() { echo "$@"; }; ${container.command[2].replace("exec ", "")}`],
    { encoding: "utf8", env: { JOB_COMPLETION_INDEX: `${index}`, SHARDS, OPTIONS } }).trim();
  const told = Array.from({ length: job.completions }, (_, index) => run(index));
  told.forEach((words, index) => assert.ok(words.includes(`--shard ${index + 1}/${SHARDS} `), words));
  assert.ok(told[0].endsWith(OPTIONS), told[0]);
  const out = told[0].split(" ")[told[0].split(" ").indexOf("--out") + 1];
  const kept = container.volumeMounts.find((mount) => mount.mountPath === out).name;
  const claim = job.template.spec.volumes.find((one) => one.name === kept).persistentVolumeClaim.claimName;
  const claimed = list.find((o) => o.kind === "PersistentVolumeClaim" && o.metadata.name === claim);
  assert.deepEqual(claimed.spec.accessModes, ["ReadWriteMany"]);
}

/** Who asks for planned grasps gets them in the same lab; whoever moves a hand goes first, and what was
    found outlives its pod. */
function planned(overlay) {
  const list = objects(root, overlay);
  const containers = pods(list).flatMap((pod) => pod.spec.containers.map((one) => ({ ...one, pod })));
  const running = (program) => containers.find((one) => one.command.includes(program));
  const planner = running("prehend-planner"), mapping = running("prehend-mapping");
  assert.ok(planner && mapping, `${overlay} has no planner`);
  assert.deepEqual(planner.envFrom, mapping.envFrom, overlay);
  // In one pod each listens at a port of its own, or takes the first free one, which may be another's.
  const port = (one) => one.command.map((word) => /^lab\.listen=.*:(\d+)$/.exec(word)?.[1]).find(Boolean);
  if (port(mapping)) {
    const ports = containers.map(port);
    assert.ok(ports.every(Boolean) && new Set(ports).size === ports.length, `${overlay}: ports ${ports}`);
  }
  const share = (one) => parseInt(one.resources.requests.cpu);
  for (const other of containers.filter((one) => one !== planner))
    assert.ok(share(planner) * 10 < share(other), `${overlay}: ${other.name} waits for the planner`);
  const folder = planner.env.find((one) => one.name === "STATE_DIRECTORY").value;
  const mount = planner.volumeMounts.find((one) => one.mountPath === folder).name;
  const claim = planner.pod.spec.volumes.find((one) => one.name === mount).persistentVolumeClaim.claimName;
  assert.ok(list.some((o) => o.kind === "PersistentVolumeClaim" && o.metadata.name === claim), overlay);
  const keys = mapping.volumeMounts.filter((one) => one.name === "keys").map((one) => one.subPath);
  const held = planner.volumeMounts.filter((one) => one.name === "keys").map((one) => one.subPath);
  assert.deepEqual(held, keys.map((role) => role.replace("mapping", "planner")), overlay);
}

let count = 0;
for (const overlay of readdirSync(root)) {
  if (!existsSync(`${root}/${overlay}/kustomization.yaml`)) continue;
  const list = objects(root, overlay);
  const claims = list.filter((o) => o.kind === "PersistentVolumeClaim").map((o) => o.metadata.name);
  for (const o of list) {
    await check(o);
    promises(overlay, o, claims);
  }
  shut(overlay, list);
  assert.deepEqual(refusals(list), [], overlay);
  count += list.length;

  if (!list.some((o) => o.kind === "Deployment")) continue;
  const misspelt = structuredClone(list.find((o) => o.kind === "Deployment"));
  misspelt.spec.template.spec.containers[0].livenesProbe = {};
  assert.equal(refusals([misspelt]).length, 1, "a field that the API does not know passes");
  const wrong = structuredClone(misspelt);
  delete wrong.spec.template.spec.containers[0].livenesProbe;
  delete wrong.spec.selector;
  await assert.rejects(check(wrong), "an object without what it must have passes");
  const open = list.filter((o) => o.metadata.name !== "deny-by-default");
  assert.throws(() => shut(overlay, open), "pods without a policy pass");
}
for (const overlay of ["planned", "robot-site-planned"]) planned(overlay);
sites();
shards();
assert.ok(count > 10, `only ${count} objects were found`);
console.log(`${count} objects are as the API wants them`);
