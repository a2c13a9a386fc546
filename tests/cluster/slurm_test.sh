#!/usr/bin/env bash
# slurm_test.sh PROGRAM SOURCE: runs the job script of docs/sweep.md, as an array of two jobs, and srun with two
# tasks under a Slurm of one node that is started for it; compares with a sweep of one process. Ends everything that it
# has started.
set -euo pipefail
# Daemons are started in the long run only (./test --full), even if Slurm is installed.
if [ -z "${MARTI_LONG_TESTS-}" ]; then
  echo "MARTI_LONG_TESTS is not set"
  exit 77
fi
program=$(realpath "$1") source=$(realpath "$2")
work=$(mktemp -d)
services=()
end_all() {
  for process in "${services[@]}"; do kill "$process" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap end_all EXIT
fail() {
  echo "$*" >&2
  tail -n 20 "$work"/*.log "$work"/*.txt >&2 2>/dev/null || true
  exit 1
}

# Daemons of our own in the foreground, with sockets and state below $work, so that none of the system's is touched.
chmod 755 "$work"
mkdir -m 700 "$work/munge" && mkdir "$work/state" "$work/spool"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 status=none
chmod 600 "$work/munge/key"
munged --foreground --force --socket="$work/munge.socket" --key-file="$work/munge/key" --num-threads=2 \
  --log-file="$work/munge/log" --pid-file="$work/munge/pid" --seed-file="$work/munge/seed" >"$work/munged.log" 2>&1 &
services+=($!)
host=$(hostname -s)
user=$(id -un)
cat >"$work/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
SelectType=select/cons_tres
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES State=UP
END
export SLURM_CONF=$work/slurm.conf
for _ in $(seq 50); do [ -S "$work/munge.socket" ] && break; sleep 0.1; done
slurmctld -D >"$work/slurmctld.log" 2>&1 &
services+=($!)
slurmd -D -N "$host" >"$work/slurmd.log" 2>&1 &
services+=($!)
for _ in $(seq 100); do
  if [ "$(sinfo -h -o %t 2>/dev/null)" = idle ]; then break; fi
  sleep 0.2
done
[ "$(sinfo -h -o %t)" = idle ] || fail "Slurm's node does not become idle"

# The first step that a batch job starts after the daemons fails now and then, so let one go by.
for _ in $(seq 5); do
  echo '#!/bin/bash
srun -n 2 true' >"$work/first.sh"
  timeout 60 sbatch --wait --nodes=1 --ntasks=2 -o "$work/first.txt" "$work/first.sh" >"$work/sbatch.log" 2>&1 &&
    [ ! -s "$work/first.txt" ] && break
done

# The document's script; options of sbatch on the command line stand before those of the script. Without its memory:
# a slurmd without control groups cannot start steps of jobs that ask for some.
sed -n '/^#!\/bin\/bash$/,/^```$/p' "$source/docs/sweep.md" | sed '/^```$/d; /^#SBATCH --mem/d' >"$work/job.sh"
[ -s "$work/job.sh" ] || fail "docs/sweep.md has no job script"
mkdir "$work/bin" && ln -s "$program" "$work/bin/marti"
cp -r "$source/configs" "$work/configs"
cp "$source/configs/sweep-small.toml" "$work/configs/sweep.toml"
cd "$work"
export PATH=$work/bin:$PATH
marti sweep configs/sweep.toml -o alone >alone.txt
same() {
  cmp "$1/points.csv" alone/points.csv || fail "the points differ from those of one process"
  [ "$(ls "$1")" = "$(ls alone)" ] || fail "parts are left in $1"
}

timeout 300 sbatch --wait --array=1-2 --cpus-per-task=1 --time=5 -o "$work/job-%a.txt" "$work/job.sh" ||
  fail "the array failed"
[ "$(cat job-1.txt job-2.txt | grep -c '^timed ')" = 2 ] || fail "the two jobs did not both time machines"
same results/sweep

printf '#!/bin/bash\nsrun marti sweep configs/sweep.toml -o srun\n' >srun.sh
timeout 300 sbatch --wait --nodes=1 --ntasks=2 --time=5 -o "$work/srun.txt" srun.sh || fail "the job failed"
[ "$(grep -c '^share ' srun.txt)" = 2 ] || fail "the two tasks did not share the sweep"
same srun
echo "passed: sweeps of two processes under Slurm give the points of one process"
