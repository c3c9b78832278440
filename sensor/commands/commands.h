/* sensor/commands/commands.h: the commands of `pitviper`, a function each.
 *
 * argv[0] is the command's name. All return the exit code: 0 done; 1 it failed, which has been logged; 2 wrong usage;
 * and where a signal may stop them 128 plus the signal's number. main.c has the table of them. */
#ifndef SENSOR_COMMANDS_COMMANDS_H
#define SENSOR_COMMANDS_COMMANDS_H

/* `pitviper run`: a node on a DIS exercise. Its frames equal to the bit those of `replay --causal` of its recording,
 * since both call the same functions at the same exercise times, with the same arrival times. */
int run_command(int argc, char **argv);
/* `pitviper replay LOG`: from a recorded exercise to images and truth. */
int replay_command(int argc, char **argv);
/* `pitviper frame FILE`: renders a saved frame again. */
int frame_command(int argc, char **argv);
/* `pitviper explain OUT FRAME X Y`: what one pixel of a saved frame is made of. */
int explain_command(int argc, char **argv);
/* `pitviper regress CASE ...`, `pitviper regress bisect OLD NEW CASE`: recorded exercises against approved baselines.
 */
int regress_command(int argc, char **argv);
/* `pitviper score OUT ANSWERS`: a recogniser's answers against the truth of a run. */
int score_command(int argc, char **argv);
/* `pitviper inspect LOG`: entities, their times and events, senders, and malformed PDUs. */
int inspect_command(int argc, char **argv);
/* `pitviper check`: validates a settings file before an exercise depends on it. */
int check_command(int argc, char **argv);
/* `pitviper exercise`: a generated exercise, written as a recording or sent on the network. */
int exercise_command(int argc, char **argv);
/* `pitviper fly`: the missiles of a scenario, flown with true sight; how close they came, and a recording. */
int fly_command(int argc, char **argv);
/* `pitviper record -o LOG`: records an exercise from the network into a capture file until SIGINT, SIGTERM, SIGHUP or
 * another signal that would end it, --for or --count; an exercise of which nothing was heard counts as recorded. */
int record_command(int argc, char **argv);
/* `pitviper model`: lists models, prints the parts of one, or renders it. */
int model_command(int argc, char **argv);
/* `pitviper heat`: a vehicle's temperatures over a clear day. */
int heat_command(int argc, char **argv);
/* `pitviper range`: how far a sensor's observer detects, recognises and identifies a target. */
int range_command(int argc, char **argv);
/* `pitviper rcs`: a target's radar cross section over aspect. */
int rcs_command(int argc, char **argv);
/* `pitviper terrain`: makes a terrain store from files, or describes one. */
int terrain_command(int argc, char **argv);
/* `pitviper terrain info STORE`, a part of it: what is in a terrain store, and pictures of it. */
int terrain_info_command(int argc, char **argv);
/* `pitviper terrain culture FILE...`, a part of it: what files of buildings, roads and trees hold. */
int terrain_culture_command(int argc, char **argv);

#endif
