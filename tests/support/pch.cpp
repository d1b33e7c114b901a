// Compiled for its precompiled header, pch.h, alone.
