"""What setuptools does not know of the package: its libraries, which are no extension modules.

They are those of the build that SKEIN_LIBRARY names (tools/wheel), or, from the source distribution, are built by CMake from
what lies in source/. jansson goes along, for they need it wherever they are installed.
"""
import os
import re
import shutil
import subprocess
import sysconfig

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

HERE = os.path.dirname(os.path.abspath(__file__))
OPTIONS = ["TESTS", "EXAMPLES", "INSTALL", "VIEWER", "FILM", "CHOLMOD", "GPU"]


def build_libraries(folder):
    """Builds them from source/; says what is missing."""
    source = os.path.join(HERE, "source")
    for tool in "cmake", "cc", "pkg-config":
        if not shutil.which(tool):
            raise SystemExit(f"skein: building from source needs {tool}: apt install gcc cmake pkg-config libjansson-dev "
                             "libepoxy-dev libegl-dev libstb-dev zlib1g-dev; or install the wheel, which needs none")
    # what is drawn with is left out where it is not there: world.render() says so then
    draws = not subprocess.run(["pkg-config", "--exists", "epoxy", "egl", "zlib"]).returncode
    options = [f"-DSKEIN_{name}=OFF" for name in OPTIONS] + [f"-DSKEIN_RENDER={'ON' if draws else 'OFF'}"]
    subprocess.run(["cmake", "-S", source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", *options], check=True)
    targets = ["skein_python"] + ["skein_python_draw"] * draws
    subprocess.run(["cmake", "--build", folder, "-j", str(os.cpu_count()), "--target", *targets], check=True)
    return os.path.join(folder, "python")


class BuildWithLibraries(build_py):
    def run(self):
        super().run()
        built = os.environ.get("SKEIN_LIBRARY") or build_libraries(os.path.join(HERE, "build", "skein"))
        to = os.path.join(self.build_lib, "skein")
        for name in "libskein.so", "libskein_draw.so":
            if name == "libskein.so" or os.path.exists(os.path.join(built, name)):
                shutil.copy(os.path.join(built, name), to)
        needs = subprocess.run(["ldd", os.path.join(built, "libskein.so")], check=True, capture_output=True, text=True).stdout
        shutil.copy(re.search(r"libjansson\S* => (\S+)", needs)[1], os.path.join(to, "libjansson.so.4"))
        licence = "/usr/share/doc/libjansson4/copyright"
        if os.path.exists(licence):
            shutil.copy(licence, os.path.join(to, "libjansson.copyright"))


class Wheel(bdist_wheel):
    """For any Python 3, on this machine's kind of system."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", sysconfig.get_platform().replace("-", "_").replace(".", "_")


setup(cmdclass={"build_py": BuildWithLibraries, "bdist_wheel": Wheel})
