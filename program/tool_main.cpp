// The program of one tool: LTE_TOOL_MAIN is its main, as cmake/LteTarget.cmake has renamed it.
int LTE_TOOL_MAIN(int argc, char** argv);

int main(int argc, char** argv) { return LTE_TOOL_MAIN(argc, argv); }
