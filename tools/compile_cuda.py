"""Compiles texts of CUDA C with NVIDIA's run-time compiler, which needs no graphics device.

    pip install nvidia-cuda-nvrtc-cu12
    python3 tools/compile_cuda.py FILE...

Ends with 0 when all are compiled, with 1 and the compiler's words when one is not, with 77 when there is no compiler.
"""

import ctypes
import importlib.util
import pathlib
import sys

NO_COMPILER = 77


def compiler():
    """The library of the package, or None."""
    for package in ("nvidia.cuda_nvrtc", "nvidia.cu13"):
        try:
            found = importlib.util.find_spec(package)
        except ModuleNotFoundError:
            continue
        for folder in found.submodule_search_locations if found else ():
            for library in sorted(pathlib.Path(folder, "lib").glob("libnvrtc.so.*")):
                return ctypes.CDLL(str(library))
    return None


def compiled(nvrtc, text):
    """None when the text is compiled, else what the compiler said."""
    program = ctypes.c_void_p()
    nvrtc.nvrtcCreateProgram(ctypes.byref(program), text.encode(), b"programs.cu", 0, None, None)
    failed = nvrtc.nvrtcCompileProgram(program, 0, None)
    size = ctypes.c_size_t()
    nvrtc.nvrtcGetProgramLogSize(program, ctypes.byref(size))
    log = ctypes.create_string_buffer(size.value)
    nvrtc.nvrtcGetProgramLog(program, log)
    nvrtc.nvrtcDestroyProgram(ctypes.byref(program))
    return log.value.decode(errors="replace") or f"error {failed}" if failed else None


def main(files):
    nvrtc = compiler()
    if nvrtc is None:
        print("no compiler: pip install nvidia-cuda-nvrtc-cu12")
        return NO_COMPILER
    code = 0
    for file in files:
        complaint = compiled(nvrtc, pathlib.Path(file).read_text(encoding="utf-8"))
        if complaint:
            print(f"{file}: {complaint}")
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
