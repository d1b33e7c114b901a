// Functions of which glibc 2.35 and GCC 12 have new versions, which would keep the wheel from older
// systems. The linker puts these in their place (--wrap), which call the first versions.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
double first_hypot(double x, double y);
float first_hypotf(float x, float y);
void first_wait(void* condition, void* lock);
__asm__(".symver first_hypot, hypot@GLIBC_2.2.5");
__asm__(".symver first_hypotf, hypotf@GLIBC_2.2.5");
__asm__(
    ".symver first_wait, "
    "_ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE@GLIBCXX_3.4.11");
double __wrap_hypot(double x, double y) { return first_hypot(x, y); }
float __wrap_hypotf(float x, float y) { return first_hypotf(x, y); }
void __wrap__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE(void* condition, void* lock) {
  first_wait(condition, lock);
}
}
// NOLINTEND(bugprone-reserved-identifier)
