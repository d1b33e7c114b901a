// The program lte.
#include "program/commands.h"

int main(int argc, char** argv) { return lte::run_command(argc, argv); }
