#pragma once
// Slurm: a job array of workers. Only sbatch, squeue and scontrol are used: accounting is not installed everywhere.

#include <string>
#include <vector>

#include "host_sim/campaign/engine.h"

namespace vbar::campaign {

[[nodiscard]] std::string submit_to_slurm(const Submission& submission);

/// One less than Slurm's MaxArraySize.
[[nodiscard]] std::size_t max_slurm_array();

/// "12_3 RUNNING"; a campaign's jobs have a name of their own, made of its folder. Empty without Slurm, and of a
/// campaign that was never submitted. Throws std::runtime_error if this computer has Slurm but squeue does not answer.
[[nodiscard]] std::vector<std::string> slurm_jobs(const Folder& folder);

}  // namespace vbar::campaign
