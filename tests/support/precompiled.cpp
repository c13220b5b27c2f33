// Nothing is here: CMake wants a source beside a precompiled header.
