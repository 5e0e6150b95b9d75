#!/bin/sh
# A Slurm cluster of one node on the loopback, for as long as a command runs:  cluster.sh DIRECTORY COMMAND [ARGUMENT...]
# Needs slurm-wlm and munge (Debian's packages), and root. Everything it writes is below DIRECTORY.
set -eu
at=$1
shift
mkdir -p "$at/state" "$at/spool" "$at/munge"
chmod 700 "$at/munge"
host=$(hostname -s)
export SLURM_CONF="$at/slurm.conf"
# One cluster at a time: its ports are fixed.
exec 9> "${TMPDIR:-/tmp}/tribo-slurm.lock"
flock 9

dd if=/dev/urandom of="$at/munge/key" bs=128 count=1 2>/dev/null
chmod 600 "$at/munge/key"
cat > "$SLURM_CONF" <<CONF
ClusterName=tribo
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$at/munge/socket
StateSaveLocation=$at/state
SlurmdSpoolDir=$at/spool
SlurmctldPidFile=$at/slurmctld.pid
SlurmdPidFile=$at/slurmd.pid
SlurmctldLogFile=$at/slurmctld.log
SlurmdLogFile=$at/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF

stop() {
    for daemon in slurmd slurmctld munge/munged; do
        [ ! -s "$at/$daemon.pid" ] || kill "$(cat "$at/$daemon.pid")" 2>/dev/null || true
    done
}
trap stop EXIT
munged --force --key-file="$at/munge/key" --socket="$at/munge/socket" --pid-file="$at/munge/munged.pid" \
    --log-file="$at/munge/log" --seed-file="$at/munge/seed"
slurmctld
slurmd
for attempt in $(seq 100); do
    [ "$(sinfo -h -o %T 2>/dev/null)" != idle ] || break
    sleep 0.2
done
[ "$(sinfo -h -o %T)" = idle ] || { cat "$at/slurmctld.log" "$at/slurmd.log" >&2; exit 9; }
"$@"
