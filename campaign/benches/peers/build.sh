#!/usr/bin/env bash
# Builds the programs that time Pinocchio, MuJoCo, CasADi's generated code and DAQP: build.sh OUT. What cannot be had is told as SKIPPED, and left out.
#
# The libraries come from PyPI: TRIBO_PYTHON, if set, is a Python that has `pin`, `cmeel-eigen`, `mujoco` and `casadi`, and stays as it is;
# otherwise a virtual environment is made in OUT. DAQP is compiled from the C sources of its PyPI archive. All with -O3 -march=native -DNDEBUG.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
out=$1
mkdir -p "$out"
# -w: the warnings are about headers that are not ours.
flags=(-w -std=c++17 -O3 -march=native -DNDEBUG -I "$here")
skip() { echo "SKIPPED $1: $2" >&2; }
command -v g++ >/dev/null || { skip "all peers" "no g++"; exit 0; }

python=${TRIBO_PYTHON:-$out/venv/bin/python}
if [ ! -x "$python" ]; then
    python3 -m venv "$out/venv" >/dev/null || { skip "all peers" "no python3 with venv"; exit 0; }
fi
[ -n "${TRIBO_PYTHON:-}" ] || for package in pin cmeel-eigen mujoco casadi; do
    "$python" -m pip install --quiet "$package" >/dev/null 2>&1
done
site=$("$python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')
version() { "$python" -c "import importlib.metadata as m; print(m.version('$1'))"; }

# Headers alone: what Pinocchio's own binary holds was compiled for any computer, not for this one.
include=$site/cmeel.prefix/include
if [ ! -d "$include/pinocchio" ] || [ ! -d "$include/eigen3" ]; then
    skip Pinocchio "pip install pin cmeel-eigen"
elif [ ! -x "$out/pinocchio" ] || [ "$here/pinocchio.cpp" -nt "$out/pinocchio" ] || [ "$here/problem.hpp" -nt "$out/pinocchio" ]; then
    # What its own package asks for: it has more joint types than Boost expects in a list.
    limits=(-DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS
        -DBOOST_FUSION_INVOKE_MAX_ARITY=12)
    g++ "${flags[@]}" "${limits[@]}" -isystem "$include" -isystem "$include/eigen3" "$here/pinocchio.cpp" -o "$out/pinocchio" ||
        skip Pinocchio "does not compile"
fi
[ -x "$out/pinocchio" ] && version pin >"$out/pinocchio.version"

library=$(ls "$site"/mujoco/libmujoco.so* 2>/dev/null | head -1)
if [ -z "$library" ]; then
    skip MuJoCo "pip install mujoco"
elif [ ! -x "$out/mujoco" ] || [ "$here/mujoco.cpp" -nt "$out/mujoco" ] || [ "$here/problem.hpp" -nt "$out/mujoco" ]; then
    g++ "${flags[@]}" -isystem "$site/mujoco/include" "$here/mujoco.cpp" "$library" -Wl,-rpath,"$site/mujoco" -o "$out/mujoco" ||
        skip MuJoCo "does not compile"
fi
[ -x "$out/mujoco" ] && version mujoco >"$out/mujoco.version"

if ! "$python" -c 'import casadi' 2>/dev/null; then
    skip "generated code" "pip install casadi"
elif "$python" "$here/generated.py" "$out" "$out" >"$out/generated.operations"; then
    g++ "${flags[@]}" -I "$out" "$here/generated.cpp" -o "$out/generated" || skip "generated code" "does not compile"
    version casadi >"$out/generated.version"
else
    skip "generated code" "CasADi does not write it"
fi

if [ ! -d "$out/daqp-source" ]; then
    archive=$out/archive
    "$python" -m pip download --quiet --no-deps --no-binary daqp -d "$archive" daqp >/dev/null 2>&1
    mkdir -p "$out/daqp-source"
    tar xzf "$archive"/daqp-*.tar.gz -C "$out/daqp-source" --strip-components 1 2>/dev/null || rmdir "$out/daqp-source"
fi
if [ ! -d "$out/daqp-source/csrc" ] || [ ! -d "$include/eigen3" ]; then
    skip DAQP "its sources from PyPI, or Eigen's (pip install cmeel-eigen)"
elif [ ! -x "$out/daqp" ] || [ "$here/daqp.cpp" -nt "$out/daqp" ] || [ "$here/problem.hpp" -nt "$out/daqp" ]; then
    objects=()
    for source in "$out"/daqp-source/csrc/src/*.c; do
        object=$out/daqp-source/$(basename "$source" .c).o
        gcc -O3 -march=native -DNDEBUG -I "$out/daqp-source/csrc/include" -c "$source" -o "$object" && objects+=("$object")
    done
    g++ "${flags[@]}" -isystem "$include/eigen3" -isystem "$out/daqp-source/csrc/include" "$here/daqp.cpp" "${objects[@]}" -o "$out/daqp" ||
        skip DAQP "does not compile"
fi
[ -x "$out/daqp" ] && sed -n 's/^Version: //p' "$out/daqp-source/PKG-INFO" | head -1 >"$out/daqp.version"
exit 0
