#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>

#include "run.h"

namespace pfsim {

void* shared_memory(std::size_t bytes) {
  void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return p == MAP_FAILED ? nullptr : p;
}

bool in_processes(int count, int processes, const char* title, void (*job)(int index, void* context), void* context) {
  std::map<pid_t, int> running;
  int next = 0, done = 0;
  bool good = true;
  const std::time_t begin = std::time(nullptr);
  while (done < count) {
    while (next < count && static_cast<int>(running.size()) < std::max(1, processes)) {
      const pid_t child = fork();
      if (child == 0) {
        job(next, context);
        _exit(0);
      }
      if (child < 0) {
        if (running.empty()) return false;
        break;
      }
      running[child] = next++;
    }
    int status = 0;
    const pid_t ended = waitpid(-1, &status, 0);
    if (ended < 0) return false;
    if (running.erase(ended) == 0) continue;
    ++done;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      std::fprintf(stderr, "\n%s: a run ended by signal %d\n", title, WIFSIGNALED(status) ? WTERMSIG(status) : 0);
      good = false;
    }
    const double spent = std::difftime(std::time(nullptr), begin);
    std::fprintf(stderr, "\r%s: %d of %d runs, %.0f s, about %.0f s to go   ", title, done, count, spent,
                 spent * (count - done) / done);
  }
  std::fprintf(stderr, "\n");
  return good;
}

}  // namespace pfsim
