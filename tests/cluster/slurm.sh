#!/bin/bash
# The Slurm recipe for real: a controller and two node daemons on loopback, one of them killed half way, nothing lost.
# As root, with Debian's slurmctld, slurmd and munge installed:
#
#     TRAINSAFE=target/release/trainsafe tests/cluster/slurm.sh
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
TRAINSAFE=$(realpath "${TRAINSAFE:-$here/target/release/trainsafe}")
export TRAINSAFE
work=$(mktemp -d)
chmod 755 "$work"
started=()
tidy() {
    scancel --user=root 2>/dev/null || true
    for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
    sleep 1
    rm -rf "$work"
}
trap tidy EXIT
cd "$work"
python3 "$here/tests/scale/make_fleet.py" trains "${TRAINS:-60}"
"$TRAINSAFE" fleet trains --out whole > /dev/null 2>&1

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

array=$(sbatch --parsable --output="$work/share-%a.log" --array=1-12 "$here/recipes/fleet.sbatch" parts trains)
finished() { grep -ls "this share is done" share-*.log 2>/dev/null | wc -l; }
for _ in $(seq 600); do
    [ "$(finished)" -ge 4 ] && break
    sleep 0.2
done
# The daemon of node b dies, and with it the share that runs there.
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
echo "killed node b with $(finished) of 12 shares done"
for _ in $(seq 1200); do
    [ -z "$(squeue --noheader)" ] && break
    sleep 0.5
done
sinfo
echo "queued again: $(grep -ci "requeue.*JobId" slurmctld.log || true) shares"
sbatch --parsable --wait --output="$work/merge.log" --wrap "$TRAINSAFE fleet --merge --out parts" > /dev/null
diff -r whole parts
echo "12 shares on two nodes, one killed: the bytes of one run ($(($(wc -l < whole/fleet.csv) - 1)) cases)"
