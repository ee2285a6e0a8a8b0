// Every object that kustomize makes of the overlays is held against the API's schemas twice: by the
// validators (what is missing, what has a wrong value) and as a literal of the API's TypeScript type,
// whose compiler also refuses fields that the API does not know. Then what we promise of every pod.
// That the check can fail is checked too: a misspelt field must be refused.
import { execFileSync } from "node:child_process";
import { readdirSync, existsSync } from "node:fs";
import assert from "node:assert/strict";
import ts from "typescript";
import { parseAllDocuments } from "yaml";

const root = process.argv[2];

/** Objects of an overlay, as `kubectl apply --kustomize` would send them. */
function objects(overlay) {
  const text = execFileSync("kubectl", ["kustomize", `${root}/${overlay}`], { encoding: "utf8" });
  return parseAllDocuments(text).map((document) => document.toJS());
}

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

function promises(overlay, o) {
  const pod = o.spec?.template?.spec;
  if (!pod) return;
  const where = `${overlay}: ${o.kind} ${o.metadata.name}`;
  assert.equal(pod.securityContext.runAsNonRoot, true, where);
  assert.equal(pod.automountServiceAccountToken, false, where);
  for (const container of pod.initContainers ?? []) locked(container, where);
  for (const container of pod.containers) {
    locked(container, where);
    if (o.kind === "Deployment" && o.metadata.name !== "discovery") {
      // What restarts a container asks its process and nothing else: with a discovery server or a
      // network between, one fault would end every process of the lab.
      for (const probe of [container.startupProbe, container.livenessProbe])
        assert.equal(probe.exec.command.join(" "), `prehend alive ${container.name}`, where);
      const ready = `prehend status --wait ${container.name} --timeout 4`;
      assert.ok(container.readinessProbe.exec.command.join(" ").startsWith(ready), where);
    }
  }
}

/** The two sites have one rig, and what one dials the other forwards to who listens there. */
function sites() {
  const find = (overlay, kind) => objects(overlay).find((o) => o.kind === kind);
  const here = find("robot-site", "ConfigMap").data, there = find("glove-site", "ConfigMap").data;
  assert.equal(here.PREHEND_LAB_RIG, there.PREHEND_LAB_RIG);
  const ports = find("robot-site", "Service").spec.ports;
  const dialled = ports.map((one) => `${here.GATEWAY}:${one.port}`);
  assert.deepEqual(JSON.parse(there.PREHEND_LAB_PEERS), dialled);
  for (const container of find("robot-site", "Deployment").spec.template.spec.containers) {
    const port = ports.find((one) => one.targetPort === container.name).port;
    assert.ok(container.command.includes(`lab.listen=$(GATEWAY):${port}`), container.name);
    assert.ok(container.ports.some((one) => one.name === container.name && one.containerPort === port));
  }
}

let count = 0;
for (const overlay of readdirSync(root)) {
  if (!existsSync(`${root}/${overlay}/kustomization.yaml`)) continue;
  const list = objects(overlay);
  for (const o of list) {
    await check(o);
    promises(overlay, o);
  }
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
}
sites();
assert.ok(count > 10, `only ${count} objects were found`);
console.log(`${count} objects are as the API wants them`);
