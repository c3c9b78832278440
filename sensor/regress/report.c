#include "sensor/regress/report.h"
Status report_write(const char *path, const CaseResult *const *result, int count) { (void)path; (void)result; (void)count; return STATUS_OK; }
