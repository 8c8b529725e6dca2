#!/bin/bash
# The Slurm recipe for real: a controller and two node daemons on loopback, one of them killed half way, nothing lost.
# As root, with Debian's slurmctld, slurmd and munge installed:
#
#     TRAINSAFE=target/release/trainsafe tests/cluster/slurm.sh
set -eu
# shellcheck source=tests/cluster/common.sh
. "$(dirname "$0")/common.sh"
trap 'scancel --user=root 2>/dev/null || true; tidy' EXIT

# A munge of our own: its key, socket and logs in the work folder.
mkdir -m 700 munge && dd if=/dev/urandom of=munge/key bs=1 count=1024 status=none && chmod 400 munge/key
mkdir socket && chmod 755 socket
/usr/sbin/munged --foreground --force --key-file munge/key --socket "$work/socket/munge" --pid-file munge/pid \
    --log-file munge/log --seed-file munge/seed > munged.log 2>&1 &
started+=($!)
host=$(hostname -s)
mkdir state spool-a spool-b
cat > slurm.conf <<CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
AuthType=auth/munge
AuthInfo=socket=$work/socket/munge,cred_expire=15
CredType=cred/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SlurmdTimeout=10
ReturnToService=0
MpiDefault=none
SwitchType=switch/none
NodeName=a NodeHostname=$host NodeAddr=127.0.0.1 Port=17001 CPUs=1
NodeName=b NodeHostname=$host NodeAddr=127.0.0.1 Port=17002 CPUs=1
PartitionName=all Nodes=a,b Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld -D > slurmctld.log 2>&1 &
started+=($!)
sleep 2
for node in a b; do
    slurmd -D -N $node > slurmd-$node.log 2>&1 &
    daemon=$!
    started+=("$daemon")
done
for _ in $(seq 60); do
    [ "$(sinfo --noheader --states=idle --Format=nodes | tr -d ' ' | head -1)" = 2 ] && break
    sleep 0.5
done
sinfo

quiet() {
    for _ in $(seq 1200); do
        [ -z "$(squeue --noheader)" ] && return
        sleep 0.5
    done
}
array=$(sbatch --parsable --output="$work/worker-%a.log" --array=1-4 "$here/recipes/fleet.sbatch" parts trains)
await $((all / 4))
# The daemon of node b dies, and with it the worker that runs there.
until job=$(squeue --noheader --nodelist=b --states=RUNNING --format=%A) && [ -n "$job" ]; do sleep 0.05; done
kill -9 "$daemon"
for pid in $(pgrep -f "slurmstepd: \[$job\."); do kill -9 "$pid" || true; done
for environment in /proc/[0-9]*/environ; do
    pid=${environment//[^0-9]/}
    of=$({ tr '\0' '\n' < "$environment"; } 2>/dev/null || true)
    if grep -qx "SLURM_JOB_ID=$job" <<< "$of" && grep -qx "SLURM_CONF=$work/slurm.conf" <<< "$of"; then
        kill -9 "$pid" || true
    fi
done
echo "killed node b with $(parts) parts done"
# All other tasks are taken from the queue: the run is left unfinished.
await $((all / 2))
scancel "$array"
quiet
early=$("$TRAINSAFE" fleet --merge --out parts 2>&1) && { echo "nothing is missing: take more TRAINS"; exit 1; }
echo "${early:0:200}"
# What is left is done by the two tasks that somebody gives again.
sbatch --output="$work/again-%a.log" --array=17,33 "$here/recipes/fleet.sbatch" parts trains
sleep 1
quiet
sbatch --parsable --wait --output="$work/merge.log" --wrap "$TRAINSAFE fleet --merge --out parts" > /dev/null || cat merge.log
diff -r whole parts
echo "an array of 4 with a node killed, cancelled, then tasks 17 and 33: the bytes of one run ($cases cases)"
