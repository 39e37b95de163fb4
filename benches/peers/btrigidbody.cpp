// What btRigidBody of Bullet does with friction: the numbers of benches/peers/atlas.py.
//
//     g++ -O1 btrigidbody.cpp -o btrigidbody -I/usr/include/bullet -lBulletDynamics -lBulletCollision -lLinearMath
//
// with libbullet-dev of Debian.
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>

const double STEP = 1e-3, GRAVITY = 9.81;

struct World {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase pairs;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &pairs, &solver, &configuration};
    // On btStaticPlaneShape the contacts chatter.
    btBoxShape ground_box{btVector3(20, 20, 1)}, box;
    btRigidBody floor{0, nullptr, &ground_box}, body;

    World(btVector3 half, double ground, double own, btVector3 scale, int mode = 0) :
        box(half), body(1, nullptr, &box, inertia(box)) {
        world.setGravity(btVector3(0, 0, -GRAVITY));
        world.getSolverInfo().m_solverMode |= mode;
        floor.setFriction(ground);
        body.setFriction(own);
        body.setActivationState(DISABLE_DEACTIVATION);
        if (scale != btVector3(1, 1, 1)) {
            body.setAnisotropicFriction(scale, btCollisionObject::CF_ANISOTROPIC_FRICTION);
            // A body that does not turn, so that the law is seen and not the effective mass.
            body.setAngularFactor(btVector3(0, 0, 0));
        }
        btTransform place = btTransform::getIdentity();
        place.setOrigin(btVector3(0, 0, -1));
        floor.setWorldTransform(place);
        place.setOrigin(btVector3(0, 0, half.z()));
        body.setWorldTransform(place);
        world.addRigidBody(&floor);
        world.addRigidBody(&body);
        run(0.2);
    }
    static btVector3 inertia(btBoxShape &box) {
        btVector3 found;
        box.calculateLocalInertia(1, found);
        return found;
    }
    double run(double time, double push = 0) {
        double highest = -1;
        for (int step = 0; step < std::lround(time / STEP); ++step) {
            if (push) body.applyCentralForce(btVector3(push, 0, 0));
            world.stepSimulation(STEP, 0);
            highest = std::fmax(highest, body.getCenterOfMassPosition().z());
        }
        return highest;
    }
};

const btVector3 CUBE(0.1, 0.1, 0.1), LONG(0.2, 0.1, 0.1), ONE(1, 1, 1);

void friction(const char *name, btVector3 half, double ground, double own, btVector3 scale, double time, int mode = 0) {
    std::printf("%s = [", name);
    for (int degrees = 15; degrees < 90; degrees += 15) {
        World one(half, ground, own, scale, mode);
        btVector3 start(2 * std::cos(degrees * M_PI / 180), 2 * std::sin(degrees * M_PI / 180), 0);
        one.body.setLinearVelocity(start);
        one.body.setAngularVelocity(btVector3(0, 0, 0));
        one.run(time);
        btVector3 force = (start - one.body.getLinearVelocity()) / (time * GRAVITY);
        double angle = std::atan2(force.y(), force.x()) * 180 / M_PI;
        std::printf("%s[%.2f, %.4f]", degrees > 15 ? ", " : "", angle, std::hypot(force.x(), force.y()));
    }
    std::printf("]\n");
}

void creep(double own, btVector3 scale, int mode = 0) {
    World creeping(CUBE, 1, own, scale, mode);
    double push = 0.5 * own * scale.x() * GRAVITY;
    creeping.run(1.5, push);
    double from = creeping.body.getCenterOfMassPosition().x();
    creeping.run(0.5, push);
    std::printf("creep = %.3g\n", (creeping.body.getCenterOfMassPosition().x() - from) / 0.5);
}

void lift(double own, btVector3 scale, int mode = 0) {
    World lifted(CUBE, 1, own, scale, mode);
    double low = lifted.body.getCenterOfMassPosition().z();
    lifted.body.setLinearVelocity(btVector3(1.52 * std::cos(1.0123), 1.52 * std::sin(1.0123), 0));
    std::printf("lift = %.2g\n", lifted.run(0.3) - low);
}

int main() {
    std::printf("# Bullet %d\n", btGetVersion());
    friction("cube", CUBE, 1, 0.5, ONE, 0.05);
    friction("long", LONG, 1, 0.5, ONE, 0.05);
    creep(0.5, ONE);
    World two(CUBE, 0.2, 0.8, ONE);
    two.body.setLinearVelocity(btVector3(2, 0, 0));
    two.run(0.05);
    std::printf("of_two = %.4f\n", (2 - two.body.getLinearVelocity().x()) / (0.05 * GRAVITY));
    lift(0.5, ONE);
    World turning(CUBE, 1, 0.5, ONE);
    turning.body.setAngularVelocity(btVector3(0, 0, 20));
    turning.run(0.05);
    double slowed = (20 - turning.body.getAngularVelocity().z()) / 0.05;
    std::printf("spin = %.3g\n", 0.02 / 3 * slowed / (0.5 * GRAVITY));
    const btVector3 scale(0.9, 0.3, 1);
    for (int mode : {0, int(SOLVER_USE_2_FRICTION_DIRECTIONS)}) {
        std::printf("setAnisotropicFriction (0.9, 0.3), solver mode %d\n", mode);
        friction("cube", CUBE, 1, 1, scale, 0.002, mode);
        friction("long", LONG, 1, 1, scale, 0.002, mode);
        creep(1, scale, mode);
        lift(1, scale, mode);
    }
    return 0;
}
