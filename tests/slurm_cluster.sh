#!/bin/sh
# slurm_cluster.sh PROGRAM: a Slurm cluster of this machine alone, for as long as the test runs, on
# which an array of examples/batch/slurm.sh makes a batch; its table is compared with that of one
# process. Ends with 77, and the reason, where Slurm cannot be started.
set -eu
program=$1
here=$(cd "$(dirname "$0")/.." && pwd)
skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" = 0 ] || skip "slurmd needs root"
for tool in munged slurmctld slurmd sbatch sinfo; do
    command -v $tool >/dev/null || skip "$tool is not installed"
done
work=$(mktemp -d)
stop() {
    for service in slurmd slurmctld munged; do
        [ ! -f "$work/$service.pid" ] || kill "$(cat "$work/$service.pid")" 2>/dev/null || true
    done
    sleep 1
    rm -rf "$work"
}
trap stop EXIT
# Ports that nobody listens at are as good as any.
port=$((20000 + $$ % 20000))
node=$(hostname -s)
mkdir "$work/state" "$work/spool"
dd if=/dev/urandom of="$work/key" bs=128 count=1 2>/dev/null
chmod 400 "$work/key"
chmod 755 "$work"
cat >"$work/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MailProg=/bin/true
SchedulerParameters=sched_interval=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES State=UP
END
export SLURM_CONF="$work/slurm.conf"
munged --force --key-file="$work/key" --socket="$work/munge.socket" \
    --pid-file="$work/munged.pid" --log-file="$work/munged.log" --seed-file="$work/seed" \
    >/dev/null 2>&1 || skip "munged does not start"
slurmctld >/dev/null 2>&1 || skip "slurmctld does not start: $(tail -n 1 "$work/slurmctld.log")"
slurmd -N "$node" >/dev/null 2>&1 || skip "slurmd does not start: $(tail -n 1 "$work/slurmd.log")"
# within SECONDS COMMAND…: waits until a command succeeds.
within() {
    left=$1
    shift
    until "$@"; do
        left=$((left - 1))
        [ $left -gt 0 ] || return 1
        sleep 1
    done
}
idle() { sinfo --noheader --format=%t 2>/dev/null | grep -q idle; }
within 30 idle || skip "the node does not become idle: $(tail -n 1 "$work/slurmd.log")"

echo '{"defaults": {"command": "project", "options": {"order": 3, "outgoing": "4"}}}' \
    >"$work/m.jsonl"
for exponent in $(seq 1 40); do
    echo "{\"input\": \"phong:exponent=$exponent\"}" >>"$work/m.jsonl"
done
mkdir "$work/bin"
ln -s "$program" "$work/bin/hshfit"
PATH="$work/bin:$PATH" sbatch --array=3-9:2 --output="$work/task-%a.txt" --mem-per-cpu=0 \
    "$here/examples/batch/slurm.sh" "$work/m.jsonl" "$work/slurm" >/dev/null
gone() { [ -z "$(squeue --noheader)" ]; }
within 120 gone || { squeue; exit 1; }
cat "$work"/task-*.txt
"$program" batch "$work/m.jsonl" -o "$work/slurm" --merge --thumbnails 0 --quiet >/dev/null
"$program" batch "$work/m.jsonl" -o "$work/one" --quiet >/dev/null
"$program" batch "$work/m.jsonl" -o "$work/one" --merge --thumbnails 0 --quiet >/dev/null
for table in table.csv table.jsonl index.html; do
    cmp "$work/slurm/$table" "$work/one/$table"
done
set -- "$work"/task-*.txt
[ $# = 4 ]
echo "the tables of an array of 4 tasks and of one process have the same bytes"
