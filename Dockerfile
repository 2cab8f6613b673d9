# The program `upglow` in a container, with the page `upglow explore` left out, as it opens a browser.
#
#   docker build --tag upglow .
#   docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD":/work upglow build -o acescg.safetensors
FROM rust:1.89-slim-bookworm AS builder
WORKDIR /upglow
COPY . .
RUN cargo build --release --locked --package upglow-cli \
    && target/release/upglow man --output man \
    && cargo xtask notices THIRD-PARTY.md \
    && target/release/upglow build --resolution 2 --output smallest.safetensors \
    && target/release/upglow verify smallest.safetensors --points 1000

FROM debian:bookworm-slim
COPY --from=builder /upglow/target/release/upglow /usr/local/bin/upglow
COPY --from=builder /upglow/man /usr/local/share/man/man1
COPY --from=builder /upglow/LICENSE-MIT /upglow/LICENSE-APACHE /upglow/tables/LICENSE.md /upglow/THIRD-PARTY.md /usr/local/share/doc/upglow/
WORKDIR /work
ENTRYPOINT ["upglow"]
