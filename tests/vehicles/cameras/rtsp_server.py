"""GStreamer's RTSP server, for the tests; run by a Python that has its bindings (Debian's own), not by the tests'.

It prints its port, then takes a line for each colour that its camera is to show, as 0xAARRGGBB.
"""

import sys
import threading

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402

ENCODERS = {
    "jpeg": ("jpegenc", "jpegenc ! rtpjpegpay name=pay0"),
    "vp8": ("vp8enc", "vp8enc deadline=1 keyframe-max-dist=10 ! rtpvp8pay name=pay0"),
    "h264": ("openh264enc", "openh264enc gop-size=10 ! h264parse ! rtph264pay name=pay0 config-interval=1"),
}


def main() -> None:
    codec, password = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
    Gst.init(None)
    element, encoder = ENCODERS[codec]
    if Gst.ElementFactory.find(element) is None:
        sys.exit(f"no {element}")
    colour, sources = [0xFF000000], []
    server, factory = GstRtspServer.RTSPServer(), GstRtspServer.RTSPMediaFactory()
    server.set_address("127.0.0.1")
    server.set_service("0")
    factory.set_launch(
        "( videotestsrc name=camera is-live=true pattern=solid-color ! "
        f"video/x-raw,format=I420,width=320,height=180,framerate=20/1 ! {encoder} )"
    )
    factory.set_shared(True)

    def on_media(_: object, media: GstRtspServer.RTSPMedia) -> None:
        source = media.get_element().get_by_name_recurse_up("camera")
        source.set_property("foreground-color", colour[0])
        sources.append(source)

    factory.connect("media-configure", on_media)
    if password:
        auth, token = GstRtspServer.RTSPAuth(), GstRtspServer.RTSPToken()
        token.set_string("media.factory.role", "user")
        auth.add_basic(GstRtspServer.RTSPAuth.make_basic("user", password), token)
        server.set_auth(auth)
        factory.add_role_from_structure(
            Gst.Structure.from_string(
                "user, media.factory.access=(boolean)true, media.factory.construct=(boolean)true"
            )[0]
        )
    server.get_mount_points().add_factory("/ahead", factory)
    server.attach(None)
    loop = GLib.MainLoop()

    def listen() -> None:
        for line in sys.stdin:
            colour[0] = int(line, 16)
            for source in sources:
                source.set_property("foreground-color", colour[0])
        loop.quit()  # whoever started it is gone

    threading.Thread(target=listen, daemon=True).start()
    print(server.get_bound_port(), flush=True)
    loop.run()


main()
