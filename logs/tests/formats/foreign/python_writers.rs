//! Files that NumPy, pandas and PyArrow wrote themselves, as far as this computer has them.

use std::path::Path;

use serde_json::json;
use tribo_logs::{ReadOptions, read};

use super::difference;
use super::motion::motion;
use crate::python_witness::{answer, python};

/// Everything that NumPy writes of one motion.
const NUMPY: &str = r#"
import json, sys, numpy as np
ask = json.load(open(sys.argv[1])); at = ask["at"]
t, q, dq, tau = (np.array(ask[k]) for k in ("t", "q", "dq", "tau"))
np.savez(at + "/rows.npz", time=t, q=q.T, dq=dq.T, tau=tau.T)
np.savez_compressed(at + "/turned.npz", t=t, q=np.asfortranarray(q.T), dq=dq, tau=np.asfortranarray(tau), names=np.array(["a", "bc"]))
rows = np.zeros(len(t), dtype=[("time", ">f8"), ("note", "S3"), ("q", "f8", 6), ("dq", "f8", 6), ("tau", "f8", 6)])
rows["time"], rows["q"], rows["dq"], rows["tau"] = t, q.T, dq.T, tau.T
np.save(at + "/structured.npy", rows)
names = ["time"] + [f"{k}{j}" for k in ("q", "dq", "tau") for j in range(6)]
np.savetxt(at + "/text.txt", np.c_[t, q.T, dq.T, tau.T], header=" ".join(names), fmt="%.17g")
print("null")
"#;

/// The same of pandas, wide, long, and with lists.
const PANDAS: &str = r#"
import json, sys, numpy as np, pandas as pd
ask = json.load(open(sys.argv[1])); at = ask["at"]
t, q, dq, tau = (np.array(ask[k]) for k in ("t", "q", "dq", "tau"))
stamp = pd.to_datetime(1700000000123456789 + np.round(t * 1e9).astype("int64"))
columns = {f"{k}_{j + 1}": v[j] for k, v in (("position", q), ("velocity", dq), ("effort", tau)) for j in range(6)}
wide = pd.DataFrame({"timestamp": stamp, **columns})
wide.to_parquet(at + "/wide.parquet")
wide.set_index("timestamp").to_parquet(at + "/indexed.parquet")
pd.DataFrame({"t": t, "q": list(q.T), "dq": list(dq.T), "tau": list(tau.T)}).to_parquet(at + "/lists.parquet", compression="zstd")
long = pd.DataFrame([dict(time=t[k], joint=f"panda_joint{j + 1}", position=q[j, k], velocity=dq[j, k], effort=tau[j, k]) for k in range(len(t)) for j in (3, 0, 1, 2, 5, 4)])
long.to_parquet(at + "/long.parquet")
long.to_csv(at + "/long.csv")
wide.assign(timestamp=stamp.astype("int64")).to_csv(at + "/semicolons.csv", sep=";", decimal=",")
print("null")
"#;

fn check(modules: &str, script: &str, files: &[&str]) {
    let Some(python) = python(modules, "tables that it writes") else { return };
    let (log, directory) = (motion(), tempfile::tempdir().unwrap());
    let question =
        json!({"at": directory.path(), "t": log.time_s, "q": log.q_rad, "dq": log.dq_rad_s, "tau": log.tau_j_nm});
    answer(&python, script, &question);
    for file in files {
        let path: &Path = &directory.path().join(file);
        let (got, _) = read(path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let worst = difference(&got, &log);
        assert!(worst < 1e-9, "{file}: {worst:.1e}");
    }
}

#[test]
fn what_numpy_writes_is_read() {
    check("numpy", NUMPY, &["rows.npz", "turned.npz", "structured.npy", "text.txt"]);
}

#[test]
fn what_pandas_writes_is_read() {
    let files = ["wide.parquet", "indexed.parquet", "lists.parquet", "long.parquet", "long.csv", "semicolons.csv"];
    check("pandas,pyarrow", PANDAS, &files);
}
