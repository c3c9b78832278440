/* etc/fmu/fmi3.h: types and functions of FMI 3.0 (Functional Mock-up Interface, co-simulation) as the binary interface
 * between a tool and this FMU has them. Source: the FMI specification, version 3.0.2, sections 2.2 and 4.2. */
#ifndef PITVIPER_FMI3_H
#define PITVIPER_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMI3_API __attribute__((visibility("default")))

typedef enum fmi3Status { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void          *fmi3Instance;
typedef void          *fmi3Environment;
typedef void          *fmi3State;
typedef const char    *fmi3String;
typedef const uint8_t *fmi3Binary;
typedef uint32_t       fmi3Reference; /* of a variable */

typedef void fmi3LogMessage(fmi3Environment environment, fmi3Status status, fmi3String category, fmi3String message);
typedef void fmi3Callback(void); /* of kinds that this FMU never calls */

FMI3_API const char  *fmi3GetVersion(void);
FMI3_API fmi3Status   fmi3SetDebugLogging(fmi3Instance, bool on, size_t count, const fmi3String categories[]);
FMI3_API fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                  bool logging, bool event_mode, bool early_return,
                                                  const fmi3Reference required[], size_t required_count,
                                                  fmi3Environment environment, fmi3LogMessage *log,
                                                  fmi3Callback *intermediate);
FMI3_API fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                   bool visible, bool logging, fmi3Environment environment,
                                                   fmi3LogMessage *log);
FMI3_API fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                        bool visible, bool logging, fmi3Environment environment,
                                                        fmi3LogMessage *log, fmi3Callback *clock, fmi3Callback *lock,
                                                        fmi3Callback *unlock);
FMI3_API void         fmi3FreeInstance(fmi3Instance);
FMI3_API fmi3Status fmi3EnterInitializationMode(fmi3Instance, bool tolerance_defined, double tolerance, double start_s,
                                                bool stop_defined, double stop_s);
FMI3_API fmi3Status fmi3ExitInitializationMode(fmi3Instance);
FMI3_API fmi3Status fmi3Terminate(fmi3Instance);
FMI3_API fmi3Status fmi3Reset(fmi3Instance);
FMI3_API fmi3Status fmi3DoStep(fmi3Instance, double at_s, double step_s, bool no_state_before, bool *event,
                               bool *terminate, bool *early, double *last_s);

/* Values: of variables `reference`, of which all are scalars: count == value_count. */
#define FMI3_VALUES(Name, type)                                                                                        \
    FMI3_API fmi3Status fmi3Get##Name(fmi3Instance, const fmi3Reference reference[], size_t count, type value[],       \
                                      size_t value_count);                                                             \
    FMI3_API fmi3Status fmi3Set##Name(fmi3Instance, const fmi3Reference reference[], size_t count, const type value[], \
                                      size_t value_count)
FMI3_VALUES(Float32, float);
FMI3_VALUES(Float64, double);
FMI3_VALUES(Int8, int8_t);
FMI3_VALUES(UInt8, uint8_t);
FMI3_VALUES(Int16, int16_t);
FMI3_VALUES(UInt16, uint16_t);
FMI3_VALUES(Int32, int32_t);
FMI3_VALUES(UInt32, uint32_t);
FMI3_VALUES(Int64, int64_t);
FMI3_VALUES(UInt64, uint64_t);
FMI3_VALUES(Boolean, bool);
FMI3_VALUES(String, fmi3String);

#endif
