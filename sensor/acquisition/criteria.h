/* sensor/acquisition/criteria.h: probabilities of an observer's tasks, from cycles on a target and from the TTP value.
 *
 * Johnson: N cycles are resolved across a target's critical dimension, here the root of its area; half of the observers
 * do the task with N50,
 *
 *     P = x^E / (1 + x^E),  x = N / N50,  E = 2.7 + 0.7 x
 *
 * (target transfer probability function: Ratches et al., Night Vision Laboratory Static Performance Model, ECOM-7043,
 * 1975; Holst, "Electro-Optical Imaging System Performance"). TTP: the same of x = V / V50 with E = 1.51 + 0.24 x
 * (Vollmerhausen, Jacobs & Driggers, "New metric for predicting target acquisition performance", Opt. Eng. 43 (2004)
 * 2806; Vollmerhausen & Jacobs, AMSEL-NV-TR-230, 2004). */
#ifndef SENSOR_ACQUISITION_CRITERIA_H
#define SENSOR_ACQUISITION_CRITERIA_H

#include "pitviper.h"

typedef enum AcquisitionTask { TASK_DETECT, TASK_RECOGNISE, TASK_IDENTIFY, acquisition_tasks } AcquisitionTask;

/* Cycles on a target, or TTP values, at which half of the observers do a task. */
typedef struct AcquisitionCriteria {
    const char *name;
    double      at50[acquisition_tasks];
    const char *source;
} AcquisitionCriteria;

/* johnson_criteria[0] is the default. */
enum { johnson_criteria_count = 3 };
extern const AcquisitionCriteria johnson_criteria[johnson_criteria_count];
extern const AcquisitionCriteria ttp_criteria;

/* x = N / N50, or V / V50, >= 0; 0.5 at 1. */
double johnson_probability(double x);
double ttp_probability(double x);

#endif
