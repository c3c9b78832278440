/* etc/fmu/refused.h: the functions of FMI 3.0 for what this FMU has not; included once, by pitviper_seeker.c.
 *
 * Each returns fmi3Error, whatever its arguments: a caller passes them in registers and on the stack, and takes them
 * away itself (System V ABI of x86-64). */
#ifndef PITVIPER_FMU_REFUSED_H
#define PITVIPER_FMU_REFUSED_H

#include "fmi3.h"

#define REFUSE(name)                                                                                                   \
    FMI3_API fmi3Status fmi3##name(fmi3Instance);                                                                      \
    fmi3Status          fmi3##name(fmi3Instance instance)                                                              \
    {                                                                                                                  \
        (void)instance;                                                                                                \
        return fmi3Error;                                                                                              \
    }
REFUSE(GetBinary)
REFUSE(SetBinary)
REFUSE(GetClock)
REFUSE(SetClock)
REFUSE(GetNumberOfVariableDependencies)
REFUSE(GetVariableDependencies)
REFUSE(GetFMUState)
REFUSE(SetFMUState)
REFUSE(FreeFMUState)
REFUSE(SerializedFMUStateSize)
REFUSE(SerializeFMUState)
REFUSE(DeserializeFMUState)
REFUSE(GetDirectionalDerivative)
REFUSE(GetAdjointDerivative)
REFUSE(EnterConfigurationMode)
REFUSE(ExitConfigurationMode)
REFUSE(GetIntervalDecimal)
REFUSE(GetIntervalFraction)
REFUSE(GetShiftDecimal)
REFUSE(GetShiftFraction)
REFUSE(SetIntervalDecimal)
REFUSE(SetIntervalFraction)
REFUSE(SetShiftDecimal)
REFUSE(SetShiftFraction)
REFUSE(EvaluateDiscreteStates)
REFUSE(UpdateDiscreteStates)
REFUSE(EnterEventMode)
REFUSE(EnterStepMode)
REFUSE(GetOutputDerivatives)
REFUSE(EnterContinuousTimeMode)
REFUSE(CompletedIntegratorStep)
REFUSE(SetTime)
REFUSE(SetContinuousStates)
REFUSE(GetContinuousStateDerivatives)
REFUSE(GetEventIndicators)
REFUSE(GetContinuousStates)
REFUSE(GetNominalsOfContinuousStates)
REFUSE(GetNumberOfEventIndicators)
REFUSE(GetNumberOfContinuousStates)
REFUSE(ActivateModelPartition)
#undef REFUSE

#endif
