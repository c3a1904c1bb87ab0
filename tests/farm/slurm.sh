#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# The script for job arrays under a real Slurm: controller, node and authentication are started on this machine, for this test
# alone. Frame 3 is killed as it runs, frame 5 is requeued by hand, the node of frame 6 dies; all frames must be whole in the end.
# Wants: slurmctld, slurmd, slurm-client, munge, python3, and root.
. "$(dirname "$0")/common.sh"

for program in slurmctld slurmd munged sbatch python3; do
  PATH=$PATH:/usr/sbin command -v "$program" > /dev/null || skip "$program is not installed (apt-get install slurmctld slurmd slurm-client munge python3)"
done
[ "$(id -u)" -eq 0 ] || skip "slurmd has to be started by root"
PATH=$PATH:/usr/sbin
script=$(cd "$(dirname "$0")/../../examples/farm" && pwd)/denoise_array.sh

daemons=()
cleanup() {
  [ ! -s "$folder/job" ] || scancel "$(cat "$folder/job")" 2> /dev/null || true
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do kill "${daemons[i]}" 2> /dev/null || true; done
  wait
  rm -rf "$folder"
}
give_up() { tail -n 20 "$folder"/*.log "$folder"/stein-*.log >&2 2> /dev/null || true; fail "$*"; }

wait_until() {  # SECONDS WHAT COMMAND...
  local left=$(($1 * 5)) what=$2
  shift 2
  until "$@" > /dev/null 2>&1; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || give_up "in vain: waited until $what"
    sleep 0.2
  done
}

free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }

export SLURM_CONF=$folder/slurm.conf
node=$(hostname -s)
mkdir "$folder/state" "$folder/spool"
cat > "$SLURM_CONF" << END
ClusterName=stein-test
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
# A requeued job waits until its old credential has expired.
AuthInfo=socket=$folder/munge.socket,cred_expire=5
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
JobRequeue=1
BatchStartTimeout=2
MessageTimeout=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES State=UP
END

start() {
  "$@" > "$folder/$1.said.log" 2>&1 &
  daemons+=($!)
}
(umask 077; head -c 128 /dev/urandom > "$folder/munge.key")
start munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
  --pid-file="$folder/munge.pid" --seed-file="$folder/munge.seed"
wait_until 10 "munged listens" test -S "$folder/munge.socket"
start slurmctld -D -c -f "$SLURM_CONF"
wait_until 30 "slurmctld answers" scontrol ping
start slurmd -D -f "$SLURM_CONF"
slurmd=$!
node_is() { sinfo -h -o %T | grep -qx "$1"; }
wait_until 30 "the node is idle" node_is idle

# What happens to some frames at their first try; the others are denoised as they are.
cat > "$folder/program" << END
#!/usr/bin/env bash
if [ "\${SLURM_RESTART_COUNT:-0}" -eq 0 ]; then
  case \$SLURM_ARRAY_TASK_ID in
    3) "$stein" "\$@" & sleep 0.03; kill -9 \$!; wait \$!; exit ;;
    5 | 6) echo \$\$ \$PPID \$(ps -o ppid= -p \$PPID) > "$folder/new"  # this, the array script, Slurm's process for it
      mv "$folder/new" "$folder/step_\$SLURM_ARRAY_TASK_ID"
      exec sleep 300 ;;
  esac
fi
exec "$stein" "\$@"
END
chmod +x "$folder/program"
for frame in 1 2 3 4 5 6; do render "$folder/noisy.000$frame.exr" "$frame" 128x96; done

export STEIN=$folder/program
cd "$folder"
job=$(sbatch --parsable --array=1-6%2 "$script" noisy.####.exr clean.####.exr --json clean.####.json)
echo "$job" > "$folder/job"
wait_until 60 "frame 5 is under way" test -e "$folder/step_5"
scontrol requeue "${job}_5"
wait_until 60 "frame 6 is under way" test -e "$folder/step_6"
# The node dies, with all that it runs, and comes back.
kill -9 "$slurmd" $(cat "$folder/step_6")
wait "$slurmd" 2> /dev/null || true
sleep 6  # longer than both timeouts: a job younger than that is not missed
start slurmd -D -f "$SLURM_CONF"
is_over() { ! squeue -h -j "$job" | grep -q .; }
wait_until 120 "the job is over" is_over

for frame in 1 2 3 4 5 6; do
  "$stein" denoise "noisy.000$frame.exr" -o expected.exr --quiet
  cmp "clean.000$frame.exr" expected.exr || give_up "frame $frame is not what a run without trouble makes"
  python3 -m json.tool "clean.000$frame.json" > /dev/null || give_up "the report of frame $frame is not whole"
done
for frame in 3 5 6; do
  grep -q "skipped\|output" "stein-${job}_$frame.log" || give_up "no second try of frame $frame"
done
left=$(find "$folder" -name '*.stein-tmp')
[ -z "$left" ] || give_up "left behind: $left"
