/* Stops the robot's arm at once. Its argument is the stop word, in the folder of the domain:
 *     cc stop_arm.c -o stop_arm && ./stop_arm "$XDG_RUNTIME_DIR/tabula/default/arm-stop" */
#include <fcntl.h>
#include <stdint.h>
#include <time.h>
#include <unistd.h>

int main(int argc, char **argv) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    uint64_t word = now.tv_sec * 1000000000ull + now.tv_nsec;
    int file = argc > 1 ? open(argv[1], O_RDWR) : -1;
    return pwrite(file, &word, sizeof word, 0) == sizeof word ? 0 : 1;
}
