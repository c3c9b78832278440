/* sensor/acquisition/criteria.c: how many cycles, and how large a TTP value, a task takes. */
#include "sensor/acquisition/criteria.h"

const AcquisitionCriteria johnson_criteria[johnson_criteria_count] = {
    {"acquire",
     {0.75, 3, 6},
     "two-dimensional criteria of FLIR92 and ACQUIRE, of the root of a target's area: Scott & D'Agostino, SPIE 1689 (1992)"},
    {"johnson",
     {1.0, 4.0, 6.4},
     "Johnson, \"Analysis of image forming systems\", Image Intensifier Symposium (1958): means of nine targets, +- 0.25, "
     "0.8, 1.5, of the least dimension"},
    {"stanag", {1, 3, 6}, "STANAG 4347 (thermal) and 4348 .. 4351 (image intensifiers): nominal static range"},
};

/* The tracked and wheeled vehicles of the night vision laboratory's trials. */
const AcquisitionCriteria ttp_criteria = {
    "vehicles",
    {2, 7.5, 13},
    "V50 of vehicles as users of the TTP metric quote them; the trials' own reports are not public"};

static double at(double x, double power)
{
    if (!(x > 0)) return isnan(x) ? NAN : 0;
    return 1 / (1 + exp(-power * log(x))); /* not x^E / (1 + x^E): both would overflow */
}

double johnson_probability(double x) { return at(x, 2.7 + 0.7 * x); }
double ttp_probability(double x) { return at(x, 1.51 + 0.24 * x); }
