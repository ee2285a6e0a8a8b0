// One overlay's pods by the container engine, as a node of a cluster would run them: every pod's
// containers with the manifest's command, user, volumes, environment and limits, in one network name
// space. The manifests' policies hold between pods.
import { execFileSync, spawnSync } from "node:child_process";
import { chmodSync, copyFileSync, mkdirSync, mkdtempSync, readdirSync, rmSync, symlinkSync } from "node:fs";
import { setTimeout as sleep } from "node:timers/promises";
import assert from "node:assert/strict";
import { matches, objects, pods, policies } from "./manifests.mjs";

const root = process.argv[2];
export const images = ["prehend-lab:latest", "prehend-vision:latest"];
const project = `prehend-pods-${process.pid}`;
const started = [];
export const docker = (...args) => execFileSync("docker", args, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] }).trim();
export const ends = (...args) => spawnSync("docker", args, { encoding: "utf8", stdio: "pipe" });
export const skip = (why) => { console.log(`SKIP: ${why}`); process.exit(77); };
const bytes = (text) => text.replace(/([KMG])i$/, (_, unit) => unit.toLowerCase());

/** One overlay in a network that several may share. */
export class Lab {
  constructor(overlay, folder, secrets = {}) {
    Object.assign(this, { overlay, secrets, name: `${project}-${overlay}`, folder: `${folder}/${overlay}` });
    this.objects = objects(root, overlay);
    this.pods = pods(this.objects);
    mkdirSync(this.folder);
  }

  /** Volumes as folders of this machine: by name, where they lie. */
  volumes(pod) {
    return Object.fromEntries((pod.spec.volumes ?? []).map((volume) => {
      const claim = volume.persistentVolumeClaim?.claimName;
      const folder = `${this.folder}/${claim ? `claim-${claim}` : `${pod.name}-${volume.name}`}`;
      // A pod that comes anew has nothing of the last one but what lies in claims.
      if (!claim) rmSync(folder, { recursive: true, force: true });
      mkdirSync(folder, { recursive: true });
      chmodSync(folder, 0o777);
      if (volume.secret) this.secret(volume.secret, folder);
      if (claim === "recordings")
        copyFileSync(`${root}/../samples/intelligent-grasp.mcap`, `${folder}/lab.mcap`);
      assert.ok(volume.emptyDir || volume.secret || volume.persistentVolumeClaim, `volume ${volume.name}`);
      return [volume.name, folder];
    }));
  }
  /** As a node lays it out: names are links into a folder with a date. */
  secret(secret, folder) {
    const from = this.secrets[secret.secretName];
    assert.ok(from, `nobody made the secret ${secret.secretName}`);
    mkdirSync(`${folder}/..date`);
    for (const file of readdirSync(from)) {
      copyFileSync(`${from}/${file}`, `${folder}/..date/${file}`);
      chmodSync(`${folder}/..date/${file}`, secret.defaultMode);
      symlinkSync(`..date/${file}`, `${folder}/${file}`);
    }
  }

  environment(container) {
    const maps = (container.envFrom ?? []).map((one) =>
      this.objects.find((o) => o.kind === "ConfigMap" && o.metadata.name === one.configMapRef.name).data);
    return Object.assign({}, ...maps, Object.fromEntries((container.env ?? []).map((e) => [e.name, e.value])));
  }

  /** The arguments of `docker run` that make it what the manifest says. */
  run(pod, container, volumes) {
    const env = this.environment(container), secured = container.securityContext;
    const user = { ...pod.spec.securityContext, ...secured };
    const mounts = (container.volumeMounts ?? []).map((mount) =>
      ["-v", `${volumes[mount.name]}${mount.subPath ? `/${mount.subPath}` : ""}:${mount.mountPath}${mount.readOnly ? ":ro" : ""}`]);
    // $(NAME) is replaced before anything runs.
    const [program, ...rest] = [...container.command, ...(container.args ?? [])]
      .map((word) => word.replace(/\$\(([A-Z_]+)\)/g, (all, name) => env[name] ?? all));
    return ["--network", `container:${this.name}-${pod.name}`,
      "--user", `${user.runAsUser}:${user.runAsGroup}`,
      ...(user.supplementalGroups ?? []).flatMap((group) => ["--group-add", `${group}`]),
      ...(secured.readOnlyRootFilesystem ? ["--read-only"] : []),
      ...(secured.allowPrivilegeEscalation === false ? ["--security-opt", "no-new-privileges"] : []),
      ...secured.capabilities.drop.flatMap((one) => ["--cap-drop", one]),
      "--memory", bytes(container.resources.limits.memory),
      ...mounts.flat(), ...Object.entries(env).flatMap(([name, value]) => ["-e", `${name}=${value}`]),
      "--entrypoint", program, container.image, ...rest];
  }

  /** What a pod's containers share: a network name space with an address and names. */
  hold(pod, network, address) {
    const services = this.objects.filter((o) => o.kind === "Service" && matches({ matchLabels: o.spec.selector }, pod.labels));
    started.push(`${this.name}-${pod.name}`);
    docker("run", "-d", "--name", `${this.name}-${pod.name}`, "--network", network,
      ...(address ? ["--ip", address] : []),
      ...services.flatMap((o) => ["--network-alias", o.metadata.name]),
      "--entrypoint", "sleep", images[0], "infinity");
    const [found, pid] = docker("inspect", "-f",
      "{{range .NetworkSettings.Networks}}{{.IPAddress}}{{end}} {{.State.Pid}}", `${this.name}-${pod.name}`).split(" ");
    Object.assign(pod, { address: found, pid });
  }

  /** The policies that hold for a pod, as filters in its name space. */
  shut(pod) {
    const held = policies(this.objects, pod);
    const filter = (...args) => execFileSync("nsenter", [`--net=/proc/${pod.pid}/ns/net`, "iptables", "-w", ...args]);
    for (const [type, chain, rules, peers, side] of [
      ["Ingress", "INPUT", (o) => o.spec.ingress, (rule) => rule.from, "-s"],
      ["Egress", "OUTPUT", (o) => o.spec.egress, (rule) => rule.to, "-d"]]) {
      const here = held.filter((o) => o.spec.policyTypes.includes(type));
      if (here.length === 0) continue;
      filter("-P", chain, "DROP");
      filter("-A", chain, type === "Ingress" ? "-i" : "-o", "lo", "-j", "ACCEPT");
      filter("-A", chain, "-m", "conntrack", "--ctstate", "ESTABLISHED,RELATED", "-j", "ACCEPT");
      for (const rule of here.flatMap((o) => rules(o) ?? []))
        for (const who of this.addresses(peers(rule)))
          for (const port of rule.ports)
            filter("-A", chain, ...(who ? [side, who] : []), "-p", port.protocol.toLowerCase(),
              "--dport", this.range(pod, port), "-j", "ACCEPT");
    }
  }
  /** Of the peers of a rule; the names of a cluster, whose pods are none of this lab, are not here. */
  addresses(peers) {
    if (!peers) return [null];
    return peers.flatMap((peer) => peer.ipBlock ? [peer.ipBlock.cidr] : peer.namespaceSelector ? []
      : this.pods.filter((pod) => matches(peer.podSelector, pod.labels)).flatMap((pod) => pod.address ?? []));
  }
  range(pod, { port, endPort }) {
    const named = pod.spec.containers.flatMap((one) => one.ports ?? []).find((one) => one.name === port);
    return endPort ? `${port}:${endPort}` : `${named ? named.containerPort : port}`;
  }

  /** What a node does with a pod that it is given, while others may be there. */
  place(pod, network, address) {
    this.hold(pod, network, address);
    for (const other of this.pods.filter((one) => one.address)) this.shut(other); // they hear of its address
    this.start(pod);
  }
  /** Asked to end and given its time, or with its node: gone without a word. */
  remove(pod, lost) {
    const containers = pod.spec.containers.map((one) => one.id);
    if (lost) ends("kill", ...containers, `${this.name}-${pod.name}`);
    else ends("stop", "--time", `${pod.spec.terminationGracePeriodSeconds ?? 30}`, ...containers);
    for (const one of [...containers, `${this.name}-${pod.name}`]) docker("rm", "-f", "-v", one);
    delete pod.address;
  }

  start(pod) {
    const volumes = this.volumes(pod);
    for (const container of pod.spec.initContainers ?? []) {
      const ended = ends("run", "--rm", ...this.run(pod, container, volumes));
      assert.equal(ended.status, 0, `${this.overlay}: ${pod.name} ${container.name}: ${ended.stderr}`);
    }
    for (const container of pod.spec.containers) {
      container.id = `${this.name}-${pod.name}-${container.name}`;
      started.push(container.id);
      docker("run", "-d", "--name", container.id,
        "--restart", pod.kind === "Job" ? "no" : "always",
        ...this.run(pod, container, volumes));
    }
  }

  async probe(pod, container, name) {
    const probe = container[name];
    if (!probe) return;
    let said = "";
    for (let i = 0; i < Math.max(probe.failureThreshold, 12); ++i) {
      const asked = ends("exec", container.id, "timeout", `${probe.timeoutSeconds}`, ...probe.exec.command);
      if (asked.status === 0) return;
      said = asked.stdout + asked.stderr;
      await sleep(1000 * Math.min(probe.periodSeconds, 2));
    }
    assert.fail(`${this.overlay}: the ${name} of ${pod.name} fails: ${said}\n${ends("logs", "--tail", "20", container.id).stderr}`);
  }

  /** Nobody may become more than the manifest says. */
  locked(pod, container) {
    const user = { ...pod.spec.securityContext, ...container.securityContext };
    const told = docker("exec", container.id, "sh", "-c",
      "id -u; id -g; sed -n 's/^\\(NoNewPrivs\\|CapEff\\|CapBnd\\|Seccomp\\):\\s*//p' /proc/1/status; touch /x 2>/dev/null && echo writes; echo $PREHEND_LAB_RIG");
    const rig = this.environment(container).PREHEND_LAB_RIG ?? "";
    assert.deepEqual(told.split("\n").join(" ").trim(),
      `${user.runAsUser} ${user.runAsGroup} ${"0".repeat(16)} ${"0".repeat(16)} 1 2 ${rig}`.trim(), `${this.overlay}: ${container.id}`);
    for (const mount of container.volumeMounts ?? []) {
      const writes = ends("exec", container.id, "touch", `${mount.mountPath}/written`).status === 0;
      assert.equal(writes, !mount.readOnly, `${container.id}: ${mount.mountPath}`);
    }
  }

  async prove() {
    const services = this.pods.filter((pod) => pod.kind === "Deployment");
    for (const probe of ["startupProbe", "readinessProbe", "livenessProbe"])
      for (const pod of services)
        for (const container of pod.spec.containers) await this.probe(pod, container, probe);
    for (const pod of services) for (const container of pod.spec.containers) this.locked(pod, container);
    for (const pod of this.pods.filter((one) => one.kind === "Job"))
      for (const container of pod.spec.containers) {
        const wait = () => spawnSync("timeout", ["400", "docker", "wait", container.id], { encoding: "utf8" }).stdout.trim();
        let code = wait();
        for (let again = 0; code !== "0" && again < pod.retries; ++again) {
          docker("start", container.id);
          code = wait();
        }
        const logs = ends("logs", "--tail", "30", container.id);
        assert.equal(code, "0", `${this.overlay}: ${pod.name}: ${logs.stdout}${logs.stderr}`);
        console.log(`${this.overlay}: the job ${pod.name} is done\n${logs.stdout}`);
      }
    const all = this.pods.flatMap((pod) => pod.spec.containers);
    console.log(`${this.overlay}: ${all.length} containers in ${this.pods.length} pods are as their manifests say`);
  }

  /** The pod of the hand is lost with its node: the stop that was ordered holds until its release. */
  async stopOutlivesItsPod(network) {
    const pod = this.pods.find((one) => one.name === "simulation"), [container] = pod.spec.containers;
    const prehend = (...words) => {
      const asked = ends("exec", container.id, "prehend", ...words);
      assert.equal(asked.status, 0, `${words.join(" ")}: ${asked.stdout}${asked.stderr}`);
      return asked.stdout;
    };
    const all = JSON.parse(this.environment(container).PREHEND_SIMULATION_HANDS ?? '["hand"]').length;
    // A busy machine may take longer to meet the lab than `status` listens for, which then says who is missing.
    const stopped = async () => {
      for (let i = 0; ; ++i) {
        const asked = ends("exec", container.id, "prehend", "status", "--once", "--json");
        assert.ok(asked.status === 0 || asked.status === 1, `status: ${asked.stdout}${asked.stderr}`);
        const { hands } = JSON.parse(asked.stdout);
        if (hands.length === all || i === 10) return hands.map((one) => one.stopped);
        await sleep(1000);
      }
    };
    prehend("stop", "--reason", "a node is about to be lost");
    this.remove(pod, true);
    this.place(pod, network);
    for (const probe of ["startupProbe", "readinessProbe"]) await this.probe(pod, container, probe);
    assert.deepEqual(await stopped(), Array(all).fill(true), `${this.overlay}: the stop was lost with its pod`);
    prehend("release", "--reason", "another node has it");
    assert.deepEqual(await stopped(), Array(all).fill(false), this.overlay);
    console.log(`${this.overlay}: a stop outlives the pod of the hand`);
  }

  /** Who has no label of the lab sees nobody, with the same settings and the same image. */
  strangerIsShutOut(network) {
    const map = this.objects.find((o) => o.kind === "ConfigMap").data;
    const asked = ends("run", "--rm", "--network", network,
      ...Object.entries(map).flatMap(([name, value]) => ["-e", `${name}=${value}`]),
      "--entrypoint", "prehend", images[0], "status", "--wait", "mapping", "--timeout", "5");
    assert.equal(asked.status, 1, `${this.overlay}: a stranger sees the lab: ${asked.stdout}${asked.stderr}`);
  }
}

export function clean() {
  // Who shares a name space goes before who holds it.
  for (const one of started.reverse()) ends("rm", "-f", "-v", one);
  started.length = 0;
}

/** A folder for what the pods keep, where pods can run at all; both are gone at the end. */
export function begin() {
  if (spawnSync("docker", ["info"]).status !== 0) skip("no container engine answers (tests/deployment/with-engine starts one)");
  for (const image of images)
    if (ends("image", "inspect", image).status !== 0) skip(`there is no image ${image}; the test containers makes it`);
  if (spawnSync("nsenter", ["--net=/proc/self/ns/net", "iptables", "-S"]).status !== 0)
    skip("policies cannot be enforced here: nsenter and iptables need root");

  const folder = mkdtempSync("/tmp/prehend-pods-");
  process.on("SIGINT", () => process.exit(130));
  process.on("SIGTERM", () => process.exit(143));
  process.on("exit", () => { clean(); rmSync(folder, { recursive: true, force: true }); });
  chmodSync(folder, 0o755);
  return folder;
}
