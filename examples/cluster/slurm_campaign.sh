#!/usr/bin/env bash
# Flies a campaign in parts as a Slurm job array, a part a task, one core each:
#
#   sbatch --array=0-99 slurm_campaign.sh 100 /shared/parts --missions 100000
#   campaign --merge /shared/parts
#
# N (here 100), the folder on a file system that all nodes see, then the options of `campaign`. A part
# should last 30 s to 5 min and more where the queue is slow. A task that was preempted or killed is queued
# again; parts that are in the folder are not flown again, so the same command resumes. `--merge` names
# what is missing: fly it with --array=NUMBERS and the same N.
#
#SBATCH --job-name=campaign
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem=512M
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=campaign-%A-%a.log
set -euo pipefail

if [ $# -lt 2 ] || [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then
    echo "usage: sbatch --array=0-(N-1) slurm_campaign.sh N FOLDER [OPTIONS OF campaign]" >&2
    exit 2
fi
parts=$1 folder=$2
shift 2
campaign=${CAMPAIGN:-campaign}
# N is an argument: the array may be a few numbers only.
exec "$campaign" "$@" --threads 1 --shard "$SLURM_ARRAY_TASK_ID/$parts" --shards-dir "$folder"
