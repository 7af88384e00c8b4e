# SPDX-License-Identifier: Apache-2.0
"""WebGL2 in a headless Chromium: generated ESSL as a browser runs it, in float32.

Playwright drives the browser that is installed. The page, `webgl.js`, draws one frame per request;
numbers go there in a file, bit for bit, and come back as text. No host name resolves in this
browser, so nothing leaves the machine.
"""

import base64
import os
import shutil
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mxeon import twins
from mxeon.hosts import Identity, NotRun, ShaderError, fragment

PROGRAM = "MXEON_CHROMIUM"  # environment variable that names another program
INSTALL = "pip install 'mxeon[webgl]'; on Debian also: apt-get install chromium"
FLAGS = (
    "--use-gl=angle",
    "--use-angle=swiftshader",  # Chromium's own software driver, alike on every machine
    "--enable-unsafe-swiftshader",
    "--no-proxy-server",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
PAGE = "<input type='file'><script>{}</script>"
IDENTITY = np.eye(4).ravel().tolist()

# ESSL gives uniforms no initial values, as GLSL does.
UNIFORMS = {
    "u_worldMatrix": IDENTITY,
    "u_viewProjectionMatrix": IDENTITY,
    "u_worldInverseTransposeMatrix": IDENTITY,
    "u_envMatrix": IDENTITY,
    "u_envLightIntensity": 1.0,
}
TRIANGLE = {"i_position": [[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], "i_normal": [[0, 0, 1]] * 3}
WHITE = np.ones((1, 1, 3), dtype=np.float32)


class Host:
    """A browser, started anew after it died.

    Parameters
    ----------
    limit : float
        Seconds that one frame may take.

    Raises
    ------
    NotRun
        If there is no Playwright, no Chromium, or no WebGL2 with float32 frames in it.
    """

    name = "webgl"
    target = "essl"
    profile = None

    def __init__(self, limit=300.0):
        self._limit = 1000.0 * limit
        self._stack = ExitStack()
        self._start()

    def identity(self):
        """Version and device as the browser names them."""
        return Identity(self.name, f"Chromium {self._version}, WebGL2", self._device)

    def evaluate(self, shader, wo, wi, inputs, branch):
        """The shader's own BSDF function for pairs of directions; see `mxeon.hosts`."""
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch)
        return self._evaluate(shader.stages["vertex"], pixel, arguments)

    def call(self, function, *arguments):
        """A function of the GLSL twins; see `mxeon.hosts`."""
        parameters = twins.signature("glsl", function)
        source = twins.source("glsl")
        pixel, named = fragment.function_evaluation(
            source, function, parameters, arguments, self.target
        )
        return self._evaluate(fragment.DIALECTS[self.target].vertex, pixel, named)

    def picture(self, shader, scene):
        """Nothing: pairs tell what a picture would.

        Raises
        ------
        NotRun
            Always.
        """
        raise NotRun("webgl: there are no pictures here; compare values instead")

    def close(self):
        """End the browser and remove the temporary file."""
        self._stack.close()
        self._page = None

    def _start(self):
        """A page with a WebGL2 context and a file for the numbers."""
        launch = _playwright()
        try:
            playwright = self._stack.enter_context(launch())
            browser = self._stack.enter_context(
                playwright.chromium.launch(
                    executable_path=_program(), args=FLAGS, chromium_sandbox=os.geteuid() != 0
                )
            )
            self._page = browser.new_page()
            self._page.set_content(PAGE.format(_script()))
            found = self._page.evaluate("identify()")
