/* tests/tools/fast_maths.c: a library that is built with fast mathematics, for tests/base/test_library.c. */
double fast_maths_twice(double x);
double fast_maths_twice(double x) { return 2 * x; }
