// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace spherechain::baker {

void become_child(pid_t parent, int last) {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) {
    struct sigaction known {};
    if (::sigaction(signal, nullptr, &known) == 0 && known.sa_handler != SIG_IGN) ::signal(signal, SIG_DFL);
  }
  ::prctl(PR_SET_PDEATHSIG, last);
  if (::getppid() != parent) ::_exit(1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);  // for the last words of libraries
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  if (nowhere > STDERR_FILENO) ::close(nowhere);
#endif
}

bool is_killed_from_outside(int status) {
  if (!WIFSIGNALED(status)) return false;
  switch (WTERMSIG(status)) {
    case SIGHUP:
    case SIGINT:
    case SIGQUIT:
    case SIGKILL:
    case SIGTERM:
    case SIGUSR1:
    case SIGUSR2:
    case SIGXCPU:
      return true;
    default:
      return false;
  }
}

}  // namespace spherechain::baker
