/* sensor/regress/regress.h: the command `pitviper regress`: exercises shown again, held against what they showed when
 * somebody looked at them and found them right. Format of a case: sensor/regress/case.h. */
#ifndef SENSOR_REGRESS_REGRESS_H
#define SENSOR_REGRESS_REGRESS_H

int regress_command(int argc, char **argv);

#endif
