// What the manifests say.
import { execFileSync } from "node:child_process";
import { parseAllDocuments } from "yaml";

/** Objects of an overlay, as `kubectl apply --kustomize` would send them. */
export function objects(root, overlay) {
  const text = execFileSync("kubectl", ["kustomize", `${root}/${overlay}`], { encoding: "utf8" });
  return parseAllDocuments(text).map((document) => document.toJS());
}

/** The pods that an overlay starts, each as name, kind, labels and spec. */
export function pods(list) {
  return list
    .filter((o) => o.spec?.template?.spec)
    .map((o) => ({ name: o.metadata.name, kind: o.kind, retries: o.spec.backoffLimit ?? 0,
                   labels: o.spec.template.metadata.labels, spec: o.spec.template.spec }));
}

export const matches = (selector, labels) =>
  Object.entries(selector.matchLabels ?? {}).every(([key, value]) => labels[key] === value);

/** The policies of an overlay that hold for a pod. */
export function policies(list, pod) {
  return list.filter((o) => o.kind === "NetworkPolicy" && matches(o.spec.podSelector, pod.labels));
}
