// SPDX-License-Identifier: GPL-3.0-or-later
// The tool that Debian 12 builds also runs with glibc 2.34 and the libstdc++ of GCC 11, as Red Hat's 9 has them. The
// linker sends the calls of two functions here (--wrap); they go on to the versions that those libraries export, which
// do the same.
extern "C" {
__asm__(".symver older_hypot, hypot@GLIBC_2.2.5");
double older_hypot(double x, double y);
double __wrap_hypot(double x, double y);
double __wrap_hypot(double x, double y) { return older_hypot(x, y); }

// std::condition_variable::wait(std::unique_lock<std::mutex>&)
__asm__(".symver older_wait, _ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE@GLIBCXX_3.4.11");
void older_wait(void* condition, void* lock);
void __wrap__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE(void* condition, void* lock);
void __wrap__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE(void* condition, void* lock) {
  older_wait(condition, lock);
}
}
