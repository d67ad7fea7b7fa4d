"""`segmap app`: the workbench as a page of its own in the browser."""

from __future__ import annotations

import os
import re
import secrets
import sys
from pathlib import Path
from typing import Annotated, Any

from segmap.arrays import Declared, Quantity
from segmap.display import pip_install

from .log_options import command, quantity

#: Icons and fonts that Voila's page asks other hosts for: the policy below would refuse them.
STRANGE = re.compile(rb'<link[^>]*href="https?://[^>]*>')
#: The names by which the page may be asked for: it is served on this machine alone.
HOSTS = r"(127\.0\.0\.1|localhost)$"
#: What the page may load and run, as tight as it works in Chromium: anywidget hands on its code as
#: `blob:`, Voila has scripts within its page (each bears the nonce) and loads others from its own
#: server, widgets set styles in place and make blobs of pictures; nothing needs `unsafe-eval`. It
#: leaves open: scripts that a trusted one makes a blob of, styles that a text brings, which can
#: hide or cover parts of the page, and pictures in a text; nothing is asked for from another host,
#: not the icons.
POLICY = (
    "default-src 'none'; script-src 'self' blob: 'nonce-{}'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; form-action 'self'; "
    "base-uri 'none'; frame-ancestors 'none'"
)
#: Voila ends the kernel when its page is asked to leave. This script delays that: a user who is
#: warned about unsaved work may stay, and the kernel ends when the page is closed.
LEAVE_SCRIPT = b"""<script>{
let gone = false;
addEventListener("beforeunload", event => {
  if (gone) return;
  event.stopImmediatePropagation();
  if (window.segmapUnsaved) event.preventDefault();
});
addEventListener("pagehide", event => {
  gone = !event.persisted;
  if (gone) dispatchEvent(new Event("beforeunload"));
});
}</script></head>"""
#: A kernel that nobody is connected to, and that does nothing, is ended after this time, seconds.
IDLE_LIMIT_S = 300
#: What --port may be.
PORT = quantity(Declared(int, Quantity(None, least=1, most=65535), (), False), "N")
#: Time between two checks for such a kernel, seconds.
IDLE_CHECK_S = 5


@command("app", "app", "app --no-browser", "app --port 8890 --no-browser")
def run(*, port: Annotated[int | None, PORT] = None, no_browser: bool = False) -> None:
    """Open the workbench in the browser: no code needed.

    It is served until Control-C; who has the address with its token sees it, nobody else.

    Parameters
    ----------
    port
        Default: one that is free.
    no_browser
        Print the address only, as without a display.
    """
    try:
        from tornado.routing import HostMatches
        from tornado.web import OutputTransform
        from voila.app import Voila
    except ImportError as error:
        raise ImportError(f"the page needs voila: {pip_install('app')}") from error

    class Guarded(OutputTransform):
        """Each answer with its policy; a page's own scripts bear a number that no other knows."""

        def transform_first_chunk(
            self, status_code: int, headers: Any, chunk: bytes, include_footers: bool
        ) -> tuple[int, Any, bytes]:
            self.mark, self.page = secrets.token_hex(16), "html" in headers.get("Content-Type", "")
            headers["Content-Security-Policy"] = POLICY.format(self.mark)
            headers["X-Content-Type-Options"] = "nosniff"
            chunk = self.transform_chunk(chunk, include_footers)
            if self.page and headers.pop("Content-Length", "") and include_footers:
                headers["Content-Length"] = str(len(chunk))
            return status_code, headers, chunk

        def transform_chunk(self, chunk: bytes, include_footers: bool) -> bytes:
            if not self.page:
                return chunk
            chunk, marked = (
                chunk.replace(b"</head>", LEAVE_SCRIPT),
                f"<script nonce={self.mark}".encode(),
            )
            return STRANGE.sub(b"", chunk.replace(b"<script", marked))

    def let_end(page: Any, **notebook: Any) -> None:
        """Give a page the cookie without which it may not end its kernel: to ask for it sets it."""
        page.xsrf_token  # noqa: B018

    class Page(Voila):  # type: ignore[misc]
        """Voila that answers to its own host: another name may lead here from a strange page."""

        def listen(self) -> None:
            for rule in self.app.default_router.rules[:-1]:
                rule.matcher = HostMatches(HOSTS)
            self.app.transforms.append(Guarded)
            self.voila_configuration.prelaunch_hook = let_end
            super().listen()

    page = Path(__file__).parents[1] / "page" / "app.ipynb"
    options = [str(page), "--Voila.ip=127.0.0.1", "--Voila.auto_token=True"]
    idle = {"cull_idle_timeout": IDLE_LIMIT_S, "cull_interval": IDLE_CHECK_S}
    options += [f"--MappingKernelManager.{name}={value}" for name, value in idle.items()]
    if port is not None:
        options += [f"--Voila.port={port}", "--Voila.port_retries=0"]
    shown = sys.platform in ("darwin", "win32") or {"DISPLAY", "WAYLAND_DISPLAY"} & {*os.environ}
    Page.launch_instance([*options, *["--no-browser"] * (no_browser or not shown)])
