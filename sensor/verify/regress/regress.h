/* sensor/verify/regress/regress.h: the command `pitviper regress`: re-renders recorded exercises and compares them
 * with approved baselines. Format of a case: sensor/verify/regress/case.h. */
#ifndef SENSOR_VERIFY_REGRESS_REGRESS_H
#define SENSOR_VERIFY_REGRESS_REGRESS_H

int regress_cases_command(int argc, char **argv);

#endif
