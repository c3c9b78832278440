/* sensor/verify/bisect/bisect.h: the command `pitviper regress bisect OLD NEW CASE`: of two versions of the program, of
 * its tables or of settings, which single difference moves a regression case. */
#ifndef SENSOR_VERIFY_BISECT_BISECT_H
#define SENSOR_VERIFY_BISECT_BISECT_H

int bisect_command(int argc, char **argv);

#endif
