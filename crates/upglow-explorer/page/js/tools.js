// Panels beside the page: build another cube, open a file. The page stays in use while one is open.

import { makeBuild } from "./build.js";
import { makeDrop } from "./drop.js";
import { element } from "./dom.js";

export function makeTools(app) {
    const [build, drop] = ["build", "drop"].map((name) => document.getElementById(name));
    const buildView = makeBuild(contentOf(build), app);
    const panels = {
        build: makePanel(build, document.getElementById("open-build"), () => buildView.open?.()),
        drop: makePanel(drop, document.getElementById("open-drop"), () => {}),
    };
    const dropView = makeDrop(contentOf(drop), app, { open: panels.drop.open, build: buildView });

    function makePanel(dialog, opener, whenOpen) {
        const title = dialog.querySelector("h2");
        title.setAttribute("tabindex", "-1");
        const close = element("button", { type: "button", class: "panel-close", "aria-label": "Close" }, "×");
        title.after(close);
        opener.setAttribute("aria-expanded", "false");
        const panel = {
            open() {
                if (!dialog.open) {
                    Object.values(panels).forEach((other) => other.close());
                    // Not modal: the page is not behind it but beside it.
                    dialog.show();
                    whenOpen();
                }
                title.focus();
                mark();
            },
            close() {
                if (dialog.open) {
                    dialog.close();
                    mark();
                }
            },
        };
        const mark = () => {
            document.body.classList.toggle("has-panel", build.open || drop.open);
            opener.setAttribute("aria-expanded", String(dialog.open));
        };
        const leave = () => {
            panel.close();
            opener.focus();
        };
        close.addEventListener("click", leave);
        addEventListener("keydown", (event) => {
            if (event.key === "Escape" && dialog.open && !document.querySelector(":modal")) {
                leave();
            }
        });
        opener.addEventListener("click", () => (dialog.open ? panel.close() : panel.open()));
        return panel;
    }

    return {
        draw(now) {
            buildView.draw(now);
            dropView.draw(now);
        },
    };
}

function contentOf(dialog) {
    dialog.classList.add("panel");
    const content = element("div", { class: "panel-content" });
    dialog.append(content);
    return content;
}
