#pragma once
// Programs of the user's own as trees of processes: a leader, and all that it starts, also in other process groups and
// sessions.

#include <sys/resource.h>
#include <sys/types.h>

namespace vbar::io {

/// Forks a leader, which has to make itself the leader of a process group. Processes that it leaves without a parent
/// become its own children as long as it lives, and afterwards those of this process (PR_SET_CHILD_SUBREAPER), where
/// reap_leader finds them. The result is that of fork.
[[nodiscard]] pid_t fork_leader();

/// waitpid for a leader: once it has ended, the processes that remain of its tree are killed and reaped if `ends_tree`,
/// those of its group before its number can be that of another. Without `ends_tree` they live on, and so does what
/// later leaders leave outside their groups. `options`: 0 or WNOHANG. True if it has ended.
bool reap_leader(pid_t leader, int options, bool ends_tree, int& status, rusage& usage);

}  // namespace vbar::io
